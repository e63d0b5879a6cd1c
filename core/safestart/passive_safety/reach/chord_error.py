"""The error of a chord: how far a solution deviates from the linear interpolation of its ends."""

from __future__ import annotations

from safestart.model.scenario import Floats
from safestart.passive_safety.reach.rounding import UP


def chord_error(length: float | Floats, second: Floats) -> Floats:
    """Bound h^2/8 sup |z''| per component over an interval of ``length`` h, rounded up; ``second`` bounds |z''|."""
    result: Floats = UP * (length**2 / 8.0) * second
    return result
