"""Cutting planes in time: the rows of one answer, the best flight and the best proof so far."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from safestart.certificates.conic import solve
from safestart.certificates.watch import Cuts, Ints, Watch
from safestart.scenario import Floats

_FIRST_TIMES = 9
# Rows without weight are dropped when farther from binding than this many brackets, in the first rounds only:
# dropping for ever could cycle.
_NO_WEIGHT, _FAR, _DROPPING_ROUNDS = 1e-7, 100.0, 12
# Two rows of one face share the weight of one touch when they are this close (in steps) and not the same (s).
_SOME_WEIGHT, _TOUCH_STEPS, _SAME_S = 1e-4, 10.0, 1e-3


class Search:
    """``lower`` and ``upper`` bracket the margin (m); ``thrust`` keeps ``lower``, ``proof`` shows ``upper``.

    ``proof`` holds (time, face, weight). ``distance_now`` is the smallest face distance of the start itself.
    """

    def __init__(self, watch: Watch, state: Floats) -> None:
        self.watch, self.state = watch, state
        self.lower, self.upper, self.rounds = -math.inf, math.inf, 0
        self.thrust: Floats | None = None
        self.proof: Sequence[tuple[float, int, float]] = ()
        distances = watch.offsets - watch.normals @ state[: watch.question.dimensions]
        self.face_now = int(np.argmin(distances))
        self.distance_now = float(distances[self.face_now])
        faces = np.arange(len(watch.names))
        later = np.linspace(0.0, watch.question.horizon, _FIRST_TIMES)[1:]
        # At t = 0 the rows hold no thrust, so the nearest face alone says all.
        times = np.concatenate([[0.0], np.repeat(later, len(faces))])
        cuts = watch.cuts(times, np.concatenate([[self.face_now], np.tile(faces, len(later))]))
        self.times, self.faces, self.rows = cuts.times, cuts.faces, cuts.thrust
        self.constant = self._constant(cuts)

    def _constant(self, cuts: Cuts) -> Floats:
        out: Floats = cuts.offset + cuts.start @ self.state
        return out

    def round(self) -> str:
        """Solve with the rows so far and watch the flight; the reason if the solver failed, else empty."""
        question = self.watch.question
        self.rounds += 1
        found = solve(
            self.constant, self.rows, question.scenario.chaser.max_acceleration, question.dimensions
        )
        if found.thrust is None or found.weights is None:
            return f"the solver stopped with {found.status} in round {self.rounds}"
        self.flown, self.load = found.thrust, found.weights
        if found.bound < self.upper:
            self.upper = found.bound
            kept = np.nonzero(found.weights > 0.0)[0]
            self.proof = list(zip(self.times[kept], self.faces[kept], found.weights[kept], strict=True))
        self.found = self.watch.minima(self.state, found.thrust)
        if self.found.lowest > self.lower:
            self.lower, self.thrust = self.found.lowest, found.thrust
        return ""

    def cut(self, goal: float) -> bool:
        """Add the local minima that lie below what the program promised; False when there is none."""
        low = self.found.values < self.upper - 0.25 * goal
        times, faces = self.found.times[low], self.found.faces[low]
        if not len(times):
            return False
        between, of = self._between()
        if self.rounds <= _DROPPING_ROUNDS:
            self._drop()
        cuts = self.watch.cuts(np.concatenate([times, between]), np.concatenate([faces, of]))
        self.times = np.concatenate([self.times, cuts.times])
        self.faces = np.concatenate([self.faces, cuts.faces])
        self.constant = np.concatenate([self.constant, self._constant(cuts)])
        self.rows = np.concatenate([self.rows, cuts.thrust])
        return True

    def _drop(self) -> None:
        """Let go of rows that carry no weight and are far from binding: the bound does not need them."""
        distance = self.constant + self.rows @ self.flown.ravel()
        near = distance < self.upper + _FAR * (self.upper - self.found.lowest)
        kept = near | (self.load > _NO_WEIGHT)
        self.times, self.faces = self.times[kept], self.faces[kept]
        self.constant, self.rows = self.constant[kept], self.rows[kept]

    def _between(self) -> tuple[Floats, Ints]:
        """Times between neighbouring rows that share the weight of one touch: the touch is near their mean."""
        carrying = np.nonzero(self.load > _SOME_WEIGHT)[0]
        carrying = carrying[np.lexsort((self.times[carrying], self.faces[carrying]))]
        one, two = carrying[:-1], carrying[1:]
        apart = self.times[two] - self.times[one]
        close = (apart > _SAME_S) & (apart < _TOUCH_STEPS * self.watch.question.dt)
        shared = close & (self.faces[one] == self.faces[two])
        one, two = one[shared], two[shared]
        first, second = self.load[one], self.load[two]
        means: Floats = (first * self.times[one] + second * self.times[two]) / (first + second)
        return means, self.faces[one]
