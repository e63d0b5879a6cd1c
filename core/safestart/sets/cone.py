"""The corridor cone as seen by separating directions: the arc of its dual cone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.model.scenario import CorridorShape, Floats


@dataclass(frozen=True, slots=True)
class DualArc:
    """Unit directions d(a) = (sin a, cos a), |a| <= ``half_angle`` (rad), that bound the corridor from below.

    ``half_width`` x0 and ``hold`` r_h in metres: inf over the corridor of d . p is r_h cos a - x0 |sin a|.
    """

    half_angle: float
    half_width: float
    hold: float

    @classmethod
    def of(cls, shape: CorridorShape) -> DualArc:
        """Arc of a corridor shape: tan(half_angle) = 1/c_x."""
        return cls(math.atan2(1.0, shape.c_x), shape.x0, shape.hold_radius)

    def nodes(self, count: int) -> Floats:
        """``count`` (odd) equally spaced angles over the arc, rad; the middle one is exactly 0."""
        half = count // 2
        return self.half_angle * (np.arange(-half, half + 1) / half)

    def offset(self, angles: Floats) -> Floats:
        """x0 |sin a| - r_h cos a in metres: minus the infimum of d . p over the corridor."""
        return self.half_width * np.abs(np.sin(angles)) - self.hold * np.cos(angles)


def directions(angles: Floats) -> Floats:
    """d(a) = (sin a, cos a), shape (..., 2)."""
    return np.stack([np.sin(angles), np.cos(angles)], axis=-1)
