"""The question: initial set, horizon, abort window, target box; and the answer per requirement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import Floats, number
from safestart.passive_safety.model import PUBLISHED, System
from safestart.passive_safety.switching_guard import supports

MAX_HORIZON = 720.0
"""Longest horizon, min."""


class Verdict(StrEnum):
    """SAFE: proved. UNSAFE: a counter-example was flown. UNKNOWN: neither, and the reason says why."""

    SAFE = "SAFE"
    UNSAFE = "UNSAFE"
    UNKNOWN = "UNKNOWN"


@dataclass(frozen=True, slots=True)
class Question:
    """Initial set ``centre`` +- ``half`` (x, y, vx, vy in m and m/min), ``horizon`` (min), abort ``window`` (min).

    ``window`` None: the engines never fail. ``box`` is the half-width (m) of the target's box; ``system`` is the
    switched system. All starts are in mode 1, so the initial set lies outside the guard. Raises ``InvalidInput``.
    """

    centre: tuple[float, float, float, float] = (-900.0, -400.0, 0.0, 0.0)
    half: tuple[float, float, float, float] = (25.0, 25.0, 0.0, 0.0)
    horizon: float = 300.0
    window: tuple[float, float] | None = None
    box: float = 0.1
    system: System = PUBLISHED

    def __post_init__(self) -> None:
        for name, value, size, most in zip(
            ["x", "y", "vx", "vy"], self.centre, self.half, (2e3, 2e3, 60.0, 60.0), strict=True
        ):
            number(f"centre.{name}", value, -most, most)
            number(f"half.{name}", size, 0.0, most)
        number("horizon", self.horizon, 0.0, MAX_HORIZON, open_low=True)
        number("box", self.box, 0.0, 100.0, open_low=True)
        if self.window is not None:
            first = number("window[0]", self.window[0], 0.0, self.horizon)
            number("window[1]", self.window[1], first, self.horizon)
        rows, limits = supports(self.system.guard)
        reach = np.abs(rows) @ np.array(self.half[:2])
        if not (rows @ np.array(self.centre[:2]) - reach > limits).any():
            guard = self.system.guard.value
            raise invalid(
                "centre", f"an initial set wholly beyond one face of the guard {guard}", self.centre
            )

    def set(self) -> tuple[Floats, Floats]:
        """Centre (4,) and generators (g, 4), one per component that varies."""
        return np.array(self.centre), np.diag(self.half)[np.array(self.half) > 0.0]


@dataclass(frozen=True, slots=True)
class Finding:
    """Answer for one requirement.

    ``bound`` is the proved extreme of the quantity that ``limit`` restricts, ``margin`` the remaining room (positive:
    the requirement holds); both None without a proof. ``counter_example`` can be replayed.
    """

    verdict: Verdict
    bound: float | None = None
    margin: float | None = None
    limit: float | None = None
    reason: str = ""
    counter_example: Mapping[str, Any] | None = None
    detail: Mapping[str, Any] = field(default_factory=dict)
