"""Powers of the size that time and memory follow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

SMALL_MIB = 2.0
"""Memory below this is the allocator's, not the work's."""


def fitted(points: Sequence[dict[str, Any]]) -> dict[str, float | None]:
    """Exponents over the larger half of the sizes, at least three: before it, fixed costs hide the growth.

    Memory has one where at least three of these sizes took more than ``SMALL_MIB``.
    """
    larger = list(points)[-max(3, (len(points) + 1) // 2) :]
    heavy = [point for point in larger if point["mib"] > SMALL_MIB]
    return {
        "time": _slope(larger, "seconds"),
        "memory": _slope(heavy, "mib") if len(heavy) >= 3 else None,
    }


def _slope(points: Sequence[dict[str, Any]], of: str) -> float:
    """Least squares of log(``of``) on log(amount)."""
    x = [math.log(point["amount"]) for point in points]
    y = [math.log(point[of]) for point in points]
    x_mean, y_mean = sum(x) / len(x), sum(y) / len(y)
    return sum((a - x_mean) * (b - y_mean) for a, b in zip(x, y, strict=True)) / sum(
        (a - x_mean) ** 2 for a in x
    )
