"""A loop about a turning reference, in the corridor: what the sets of a hold are made from.

Between watched instants, h apart, a distance falls by at most h^2 / 8 times the bound on its second derivative below
its chord; the sets give that much away.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

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
Loss = Literal["none", "sag", "rise"]


@dataclass(frozen=True, slots=True)
class Room:
    """What the reference leaves of one limit, ``room`` (m, m/s^2 or m/s); errors of level rho take up to
    sqrt(rho ``reach``) of it. ``loss`` says what is lost between watched instants: a distance sags, a speed rises."""

    name: str
    room: float
    reach: float
    loss: Loss = "none"


@dataclass(frozen=True, slots=True)
class Loop:
    """Errors e (m,) of a loop: its first four are of (x, y, vx, vy), LVLH; thrust is the reference's + ``rows`` e.

    ``closed`` (m, m) moves e by a step, and e' ``cost`` e never grows. ``corridor`` planar, ``most`` the thrust limit,
    m/s^2.
    """

    reference: TurningReference
    corridor: Corridor
    most: float
    rows: Floats
    closed: Floats
    cost: Floats

    @property
    def usable(self) -> float:
        """Thrust that the sets may use, m/s^2."""
        return self.most

    def conditions(self) -> tuple[Room, ...]:
        """What else must hold at every node for the loop to stay as it is."""
        return ()

    def instants(self) -> Floats:
        """Watched times after a node, s, (WATCHED,)."""
        return self.reference.step * np.arange(WATCHED) / WATCHED

    def moved(self, tau: float, *, velocity: bool = False) -> Floats:
        """Rows (2, m): the error of the position ``tau`` s after a node, or of the velocity."""
        n = self.reference.mean_motion
        at = slice(2, 4) if velocity else slice(0, 2)
        out = planar_input(n, tau)[at] @ self.rows
        out[:, :4] += planar_transition(n, tau)[at]
        return np.asarray(out)

    def reach_of(self, rows: Floats) -> float:
        """Largest |``rows`` e|^2 over e' P e <= 1."""
        return float(np.linalg.eigvalsh(rows @ np.linalg.inv(self.cost) @ rows.T)[-1])

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


@dataclass(frozen=True, slots=True)
class Hold(Loop):
    """The LQR's loop; the thrust's disk is replaced by an inner polygon."""

    design: Design

    @classmethod
    def of(cls, design: Design, reference: TurningReference, corridor: Corridor, most: float) -> Hold:
        """The loop of one design."""
        return cls(reference, corridor, most, -design.gain, design.closed_loop, design.cost, design)

    @property
    def usable(self) -> float:
        """Thrust that the inner polygon of the disk holds in every direction, m/s^2."""
        return self.most * math.cos(math.pi / SIDES)
