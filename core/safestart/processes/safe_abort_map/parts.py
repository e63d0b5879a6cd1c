"""Parts of a safe-abort map: runs of starts. Light to import, so that the service can show what is known so far."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from typing import Any

from safestart.processes.safe_abort_map.spec import SafeAbortMapInputs


def places(inputs: SafeAbortMapInputs) -> list[tuple[float, float]]:
    """Starts (x, y) in m: ring by ring from inside out, or row by row in y."""
    if inputs.starts == "grid":
        grid = inputs.grid
        columns = _linspace(grid.x_from_m, grid.x_to_m, grid.nx)
        return [(x, y) for y in _linspace(grid.y_from_m, grid.y_to_m, grid.ny) for x in columns]
    arc = inputs.arc
    angles = [math.radians(angle) for angle in _linspace(arc.from_deg, arc.to_deg, arc.angles)]
    rings = _linspace(arc.inner_m, arc.outer_m, arc.rings)
    return [(radius * math.cos(angle), radius * math.sin(angle)) for radius in rings for angle in angles]


def _linspace(first: float, last: float, count: int) -> list[float]:
    return [first + (last - first) * k / max(1, count - 1) for k in range(count)]


def split(inputs: SafeAbortMapInputs) -> list[dict[str, Any]]:
    """Parts of ``starts_per_shard`` starts; each holds its starts and all else that its result depends on."""
    keys = {"starts", "arc", "grid", "starts_per_shard"}
    common = inputs.model_dump(mode="json", exclude=keys)
    starts, size = places(inputs), inputs.starts_per_shard
    return [{"common": common, "places": starts[k : k + size]} for k in range(0, len(starts), size)]


def summary(inputs: SafeAbortMapInputs, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """What the shards at hand say; starts without an answer are null."""
    starts = places(inputs)
    known = {(x, y): k for k, (x, y) in enumerate(starts)}
    apart: list[float | None] = [None] * len(starts)
    proved: list[float | None] = [None] * len(starts)
    reasons: Counter[str] = Counter()
    done, answered = 0, 0
    for document in documents:
        done += 1
        for x, y, separation, requirements, reason in document["starts"]:
            answered += 1
            apart[known[x, y]], proved[known[x, y]] = separation, requirements
            if reason:
                reasons[reason] += 1
    return {
        "x_m": [x for x, _ in starts],
        "y_m": [y for _, y in starts],
        "safe_abort_until_min": apart,
        "all_proved_until_min": proved,
        "reasons": dict(sorted(reasons.items())),
        "shards_done": done,
        "starts_done": answered,
    }
