"""Cutting planes in time: the rows of one answer, the best flight and the best proof so far."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from safestart.certificates.conic import solve
from safestart.certificates.watch import Cuts, Ints, Watch
from safestart.scenario import Floats

_FIRST_TIMES = 9
# What floats may lose of a distance, relative to the length a flight can cover: some hundred roundings.
_ROUNDING = 1e-13
# Rows without weight are dropped when farther from binding than this many brackets, in the first rounds only:
# dropping for ever could cycle.
_NO_WEIGHT, _FAR, _DROPPING_ROUNDS = 1e-7, 100.0, 12
# Rows with some weight share one touch with a minimum this close (in steps). The first guess of a touch lies this part
# of the way from the weight to the minimum; times closer than a millisecond are the same.
_SOME_WEIGHT, _TOUCH_STEPS, _FIRST_GUESS, _SAME_S = 1e-4, 10.0, 0.6, 1e-3


class Search:
    """``lower`` and ``upper`` bracket the margin (m); ``thrust`` keeps ``lower``, ``proof`` shows ``upper``.

    ``proof`` holds (time, face, weight). ``distance_now`` is the smallest face distance of the start itself.
    """

    def __init__(self, watch: Watch, state: Floats) -> None:
        self.watch, self.state = watch, state
        self.lower, self.upper, self.rounds = -math.inf, math.inf, 0
        self.thrust: Floats | None = None
        question = watch.question
        speed = float(np.abs(state[question.dimensions :]).sum())
        push = question.scenario.chaser.max_acceleration * question.horizon
        reach = float(np.abs(state[: question.dimensions]).sum()) + (speed + push) * question.horizon
        self.rounding = _ROUNDING * reach
        self.dips: dict[int, tuple[float, float]] = {}
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
        if found.bound + self.rounding < self.upper:
            self.upper = found.bound + self.rounding
            kept = np.nonzero(found.weights > 0.0)[0]
            self.proof = list(zip(self.times[kept], self.faces[kept], found.weights[kept], strict=True))
        self.found = self.watch.minima(self.state, found.thrust)
        if self.found.lowest - self.rounding > self.lower:
            self.lower, self.thrust = self.found.lowest - self.rounding, found.thrust
        return ""

    def cut(self, goal: float) -> bool:
        """Add the local minima that lie below what the program promised; False when there is none."""
        low = self.found.values < self.upper - 0.25 * goal
        times, faces = self.found.times[low], self.found.faces[low]
        if not len(times):
            return False
        between, of = self._touches(times, faces)
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

    def _touches(self, times: Floats, faces: Ints) -> tuple[Floats, Ints]:
        """Where the best flight probably touches: a secant on (time of the weight, time of the flight's minimum).

        Weight on one time makes the flight dip on the other side of the touch, at a distance smaller by a factor that
        hardly changes: the dips would close in on the touch by about a half each round, the secant does so at once.
        """
        out_times, out_faces = [], []
        reach = _TOUCH_STEPS * self.watch.question.dt
        for time, face in zip(times.tolist(), faces.tolist(), strict=True):
            share = (self.faces == face) & (np.abs(self.times - time) < reach) & (self.load > _SOME_WEIGHT)
            total = float(self.load[share].sum())
            if total == 0.0:
                continue
            carried = float(self.load[share] @ self.times[share]) / total
            dip = time - carried
            before = self.dips.get(face)
            self.dips[face] = (carried, dip)
            touch = carried + _FIRST_GUESS * dip
            if before is not None and before[1] * dip < 0.0:
                touch = carried + dip * (before[0] - carried) / (dip - before[1])
            if min(abs(touch - time), abs(dip)) > _SAME_S and 0.0 < touch < self.watch.question.horizon:
                out_times.append(touch)
                out_faces.append(face)
        return np.array(out_times), np.array(out_faces, dtype=np.int64)
