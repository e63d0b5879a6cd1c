"""How a chaser moves relative to a target: the interfaces that every motion offers.

States are LVLH position and velocity (x, y, z, vx, vy, vz), m and m/s; times are seconds since the flight's start.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from safestart.model.scenario import Floats


class RelativeMotion(Protocol):
    """A linear motion, which may vary with time. Derive from it and give the two matrices.

    Everything that predicts takes a motion by these two. Motions are equal, and hashed, by value (a frozen dataclass):
    what is tabulated for one is kept.
    """

    def transition(self, t0: float, t1: float) -> Floats:
        """Phi(t1, t0), (6, 6): the state at t1 of a chaser that drifts from t0."""
        ...

    def held(self, t0: float, t1: float) -> Floats:
        """(6, 3): what one unit of thrust, held in LVLH axes from t0 to t1, adds to the state at t1."""
        ...


@runtime_checkable
class SteadyMotion(RelativeMotion, Protocol):
    """A linear motion in which only t1 - t0 counts: the tables of one interval serve for all of them."""

    def positions(self, tau: Floats, dimensions: int) -> tuple[Floats, Floats]:
        """Position rows of ``transition``, (J, d, 2 d), and of ``held``, (J, d, d), over J durations ``tau``, s.

        d = 2 leaves out z, on which the motion in the plane does not depend.
        """
        ...
