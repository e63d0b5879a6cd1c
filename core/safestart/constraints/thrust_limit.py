"""The thrusts that a chaser can hold over an interval: a ball, a box, or the hull of a set of thrusters.

Every set is a linear image u = P w of a unit set (:mod:`safestart.optim.thrust_shapes`): ball, cube or simplex. Axes
are those of LVLH, or of the body at the beginning of the interval; the thrust itself is held in LVLH.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import MAX_ACCELERATION, MIN_ACCELERATION, Floats, number

Frame = Literal["lvlh", "body"]
Vector = tuple[float, float, float]
MOST_THRUSTERS = 32


@dataclass(frozen=True, slots=True)
class ThrustLimit:
    """``kind`` "ball" (``a_max``: one number), "box" (three half-widths) or "thrusters" (one for each), m/s^2.

    Thrusters may be throttled and combined with shares of sum at most 1: the hull of their thrusts and 0.
    ``directions`` are scaled to unit length. Raises ``InvalidInput`` for numbers out of range and for thrusters that do
    not span space.
    """

    kind: Literal["ball", "box", "thrusters"]
    a_max: tuple[float, ...]
    directions: tuple[Vector, ...] = ()
    frame: Frame = "lvlh"

    def __post_init__(self) -> None:
        wanted = {"ball": 1, "box": 3, "thrusters": len(self.directions)}.get(self.kind)
        if wanted is None:
            raise invalid("kind", "ball, box or thrusters", self.kind)
        if self.frame not in ("lvlh", "body"):
            raise invalid("frame", "lvlh or body", self.frame)
        if len(self.a_max) != wanted or not 1 <= wanted <= MOST_THRUSTERS:
            raise invalid(
                "a_max", f"{wanted} numbers for this {self.kind}, at most {MOST_THRUSTERS}", self.a_max
            )
        least = 0.0 if self.kind == "box" else MIN_ACCELERATION
        bounds = tuple(number("a_max", e, least, MAX_ACCELERATION) for e in self.a_max)
        if max(bounds) < MIN_ACCELERATION:
            raise invalid("a_max", f"one of at least {MIN_ACCELERATION:g} m/s^2", self.a_max)
        object.__setattr__(self, "a_max", bounds)
        for direction in self.directions:
            if len(direction) != 3 or not 1e-9 < math.hypot(*direction) < 1e9:
                raise invalid("directions", "three finite numbers each, not all 0", direction)
        if (
            self.kind == "thrusters"
            and np.linalg.matrix_rank(self.pushes / np.abs(self.pushes).max(), 1e-6) < 3
        ):
            raise invalid(
                "directions", "thrusters that span a cone in space, three of them at least", self.directions
            )

    @property
    def channels(self) -> int:
        """The number of components of one point."""
        return len(self.directions) if self.kind == "thrusters" else 3

    @property
    def pushes(self) -> Floats:
        """P (3, channels), m/s^2, in the set's own axes."""
        if self.kind == "thrusters":
            found = np.array(self.directions).T
            out: Floats = found / np.linalg.norm(found, axis=0) * np.array(self.a_max)
            return out
        return np.diag(np.broadcast_to(np.array(self.a_max), 3))

    @property
    def largest(self) -> float:
        """Largest size of a thrust, m/s^2."""
        return math.hypot(*self.a_max) if self.kind == "box" else max(self.a_max)


def ball(a_max: float) -> ThrustLimit:
    """Limit thrust in every direction to ``a_max`` m/s^2."""
    return ThrustLimit("ball", (a_max,))
