"""How a chaser moves relative to a target: the interfaces of every motion.

States are LVLH position and velocity (x, y, z, vx, vy, vz), m and m/s; times are seconds since the flight's start.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np

from safestart.model.scenario import Floats


class Underway(Protocol):
    """One chaser in flight; ``state`` (6,) is its current state."""

    state: Floats

    def push(self, impulse: Floats) -> None:
        """Change the velocity at once by ``impulse`` (3,), m/s, LVLH."""
        ...

    def fly(self, thrust: Floats, times: Floats) -> Floats:
        """States (T, 6) at ``times`` (T,), the first of which is now, with ``thrust`` (3,) m/s^2 held in LVLH axes."""
        ...


class Motion(Protocol):
    """Any relative motion, linear or not."""

    def start(self, state: Floats) -> Underway:
        """A chaser at ``state`` (6,) at t = 0."""
        ...


class RelativeMotion(Protocol):
    """A linear motion, which may vary with time. Derive from it and implement the two matrices.

    All predictions use only these two; ``start`` lets every linear motion fly in the loop. Motions are compared and
    hashed by value (frozen dataclasses), so that tables can be cached per motion.
    """

    def transition(self, t0: float, t1: float) -> Floats:
        """Phi(t1, t0), (6, 6): the state at t1 of a chaser that drifts from t0."""
        ...

    def held(self, t0: float, t1: float) -> Floats:
        """(6, 3): the effect on the state at t1 of one unit of thrust, held in LVLH axes from t0 to t1."""
        ...

    def start(self, state: Floats) -> Underway:
        """A chaser at ``state`` (6,) at t = 0."""
        return Drift(self, state)


@runtime_checkable
class SteadyMotion(RelativeMotion, Protocol):
    """A linear motion that depends only on t1 - t0, so that one interval's tables serve all intervals."""

    def positions(self, tau: Floats, dimensions: int) -> tuple[Floats, Floats]:
        """Position rows of ``transition``, (J, d, 2 d), and of ``held``, (J, d, d), over J durations ``tau``, s.

        d = 2 leaves out z, on which the motion in the plane does not depend.
        """
        ...


@runtime_checkable
class ManyMoves(RelativeMotion, Protocol):
    """A linear motion that gives the matrices of many intervals at once."""

    def moves(self, begin: Floats, end: Floats) -> tuple[Floats, Floats]:
        """``transition`` (J, 6, 6) and ``held`` (J, 6, 3) from ``begin`` (J,) to ``end`` (J,), s."""
        ...


class Drift:
    """A chaser in a linear motion; every state comes directly from the interval's first state."""

    def __init__(self, motion: RelativeMotion, state: Floats) -> None:
        self._motion, self.state = motion, np.array(state, dtype=np.float64)

    def push(self, impulse: Floats) -> None:
        """See :class:`Underway`."""
        self.state[3:] += impulse

    def fly(self, thrust: Floats, times: Floats) -> Floats:
        """See :class:`Underway`."""
        begin, *later = times.tolist()
        out = np.empty((len(times), 6))
        out[0] = self.state
        for row, time in enumerate(later, 1):
            out[row] = self._motion.transition(begin, time) @ self.state
            out[row] += self._motion.held(begin, time) @ thrust
        self.state = out[-1].copy()
        return out
