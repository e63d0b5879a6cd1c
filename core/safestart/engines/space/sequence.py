"""MPC over the whole thrust sequence in space, as :mod:`safestart.control.sequence_mpc` in the plane.

Each step checks the tail of its plan from the state that navigation sees, and asks the exact question for the rest of
the flight again only where the tail no longer keeps half of the plan's margin. If no plan keeps the faces it flies the
one that leaves them least.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from safestart.attitude.turning import Bounds, SmoothAttitude
from safestart.control.controller import Command
from safestart.control.sequence_mpc import KEPT, TOLERANCE
from safestart.exact.answer import GUARD
from safestart.exact.search import Search
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.space.watch import SpaceWatch
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import Floats

_ON_PLAN_M = 1e-6
"""A chaser this near to its plan, and to be this near at the end, is on it."""


@dataclass(frozen=True)
class Later:
    """``attitude`` with its times counted from ``begin`` s on."""

    attitude: SmoothAttitude
    begin: float

    def rotation(self, times: Floats) -> Floats:
        """(..., 3, 3): LVLH coordinates to body coordinates."""
        return self.attitude.rotation(np.asarray(times) + self.begin)

    def angular_velocity(self, times: Floats) -> Floats:
        """(..., 3), rad/s, of the body against LVLH, in body axes."""
        return self.attitude.angular_velocity(np.asarray(times) + self.begin)

    def rate_bounds(self) -> tuple[float, float]:
        """The attitude's bounds: they hold at all times."""
        return self.attitude.rate_bounds()

    @property
    def knots(self) -> Floats:
        """The attitude's knots, s after ``begin``."""
        return self.attitude.knots - self.begin

    def turn_bounds(self) -> Bounds:
        """The attitude's bounds: they hold at all times."""
        return self.attitude.turn_bounds()


def later(question: SpaceQuestion, steps: int) -> SpaceQuestion:
    """The rest of a question after ``steps`` intervals."""
    begin, orbit = steps * question.dt, question.orbit
    if not orbit.circular:
        moved = orbit.true_anomaly + float(orbit.turned(np.array(begin)))
        orbit = KeplerOrbit(orbit.mean_motion, orbit.eccentricity, moved)
    return replace(
        question, orbit=orbit, attitude=Later(question.attitude, begin), steps=question.steps - steps
    )


class SequenceInSpace:
    """A controller: the plan's thrust, from a new plan when the old one no longer holds."""

    def __init__(self, question: SpaceQuestion) -> None:
        self._question = question
        self._watches: dict[int, SpaceWatch] = {}
        self._points: Floats = np.empty((0, question.channels))
        self._nodes: Floats = np.empty((0, 6))
        self._first, self._margin = 0, -np.inf

    def begin(self, state: Floats) -> None:  # noqa: ARG002
        """No plan yet."""
        self._points = self._points[:0]

    def command(self, k: int, state: Floats) -> Command:
        """See :class:`safestart.control.controller.Controller`; feasible where the plan keeps the faces."""
        watch = self._watch(k)
        label = "kept"
        if not self._kept(watch, k, state):
            label = "planned"
            search = Search(watch, state)
            search.narrow(TOLERANCE)
            coast = np.zeros((watch.question.steps, self._question.channels))
            self._points = coast if search.thrust is None else search.thrust
            self._first, self._margin = k, search.lower
            nodes = watch.flown(state, self._points)
            ends = np.nonzero(np.diff(watch.intervals))[0]
            self._nodes = np.concatenate([nodes[:1], nodes[ends + 1]])
        thrust = watch.accelerations(self._points[k - self._first :])[0]
        return Command(thrust, self._margin > GUARD, label)

    def _kept(self, watch: SpaceWatch, k: int, state: Floats) -> bool:
        if not len(self._points):
            return False
        off = np.abs(state - self._nodes[k - self._first]).max()
        if off * (1.0 + watch.question.horizon) < _ON_PLAN_M:
            return True
        left = watch.minima(state, self._points[k - self._first :]).lowest
        # Of a plan that leaves the faces the rest is flown as long as it leaves them no further.
        return bool(left >= (KEPT * self._margin if self._margin > 0.0 else self._margin - TOLERANCE))

    def _watch(self, k: int) -> SpaceWatch:
        if k not in self._watches:
            self._watches[k] = SpaceWatch(later(self._question, k))
        return self._watches[k]
