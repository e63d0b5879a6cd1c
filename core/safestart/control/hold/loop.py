"""The LQR's loop about the turning reference, in the corridor: what its sets are made from.

Between watched instants, h apart, a distance falls by at most h^2 / 8 times the bound on its second derivative below
its chord; the sets give that much away. The thrust's disk is replaced by an inner polygon.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.constraints.corridor import Corridor
from safestart.control.hold.hold_lqr import Design
from safestart.control.hold.turning_reference import TurningReference
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.model.scenario import Floats

WATCHED = 8
"""Instants watched in each step."""
SIDES = 48
"""Sides of the polygon inside the thrust disk."""


@dataclass(frozen=True, slots=True)
class Hold:
    """One loop and its limits; ``corridor`` planar, ``most`` the thrust limit, m/s^2."""

    design: Design
    reference: TurningReference
    corridor: Corridor
    most: float

    @property
    def usable(self) -> float:
        """Thrust that the inner polygon of the disk holds in every direction, m/s^2."""
        return self.most * math.cos(math.pi / SIDES)

    def instants(self) -> Floats:
        """Watched times after a node, s, (WATCHED,)."""
        return self.reference.step * np.arange(WATCHED) / WATCHED

    def moved(self, tau: float, *, velocity: bool = False) -> Floats:
        """Position rows (2, 4) of M(tau), or those of the velocity."""
        n = self.reference.mean_motion
        rows = slice(2, 4) if velocity else slice(0, 2)
        return np.asarray((planar_transition(n, tau) - planar_input(n, tau) @ self.design.gain)[rows])

    def sag(self, position: float, velocity: float) -> float:
        """How far a distance can fall below its chord, m, while errors at nodes are at most m and m/s in size."""
        n, rate = self.reference.mean_motion, self.reference.rate
        p, v = self._farthest(position, velocity)
        bend = self.most + 3.0 * n * n * p + 2.0 * n * v + 2.0 * rate * v + rate * rate * p
        return (self.reference.step / WATCHED) ** 2 / 8.0 * bend

    def rise(self, position: float, velocity: float) -> float:
        """How far a speed in LVLH can rise above the larger of its neighbours', m/s, with the same errors."""
        n = self.reference.mean_motion
        p, v = self._farthest(position, velocity)
        return 0.5 * self.reference.step / WATCHED * (self.most + 3.0 * n * n * p + 2.0 * n * v)

    def _farthest(self, position: float, velocity: float) -> tuple[float, float]:
        """Bounds on distance from the target, m, and speed, m/s, at all times."""
        n, step = self.reference.mean_motion, self.reference.step
        p = position + float(np.abs(self.reference.state[:2]).max()) * math.sqrt(2.0)
        v = velocity + float(np.linalg.norm(self.reference.state[2:]))
        # In a step the speed grows by a few times the largest acceleration's share; 1.5 covers e^(n step) < 1.1.
        v += 1.5 * step * (self.most + 3.0 * n * n * p + 2.0 * n * v)
        p += 1.5 * step * v
        return p, v
