"""Cutting planes in time: the rows of one answer, the best flight and the best proof so far."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from safestart.exact.answer import BETWEEN, GUARD, TOLERANCE, Evidence, Multiplier
from safestart.exact.cut_source import Watched
from safestart.exact.limits import AT_END, SPEED, speed_limit
from safestart.exact.watch import Cuts, Ints
from safestart.model.scenario import Floats
from safestart.optim.largest_margin import solve

_FIRST_TIMES = 9
FINEST = 2e-7
# Programs are solved to the last digits only where the bracket (m) is this narrow: a wide one closes by rows.
NARROW = 1e-2
MOST_ROUNDS = 40
# Rows without weight are dropped when farther from binding than this many brackets, but only in the first rounds,
# because later drops could cycle.
NO_WEIGHT, FAR, DROPPING_ROUNDS = 1e-7, 100.0, 12
# A weighted row and a minimum this close (in steps) belong to one touch. The first guess of a touch lies this share of
# the way from the weight to the minimum; times closer than a millisecond count as equal.
SOME_WEIGHT, TOUCH_STEPS, FIRST_GUESS, SAME_S = 1e-4, 10.0, 0.6, 1e-3


class Search:
    """``lower`` and ``upper`` bracket the margin (m); ``thrust`` keeps ``lower``, ``evidence`` proves ``upper``.

    ``distance_now`` is the smallest margin of the start itself, proved by the multiplier ``now``.
    """

    def __init__(self, watch: Watched, state: Floats) -> None:
        self.watch, self.state = watch, state
        self.lower, self.upper, self.rounds = -math.inf, math.inf, 0
        self.thrust: Floats | None = None
        question = watch.question
        self.flown: Floats = np.zeros((question.steps, question.channels))
        self.rounding = rounding_of(watch, state)
        self.dips: dict[int, tuple[float, float]] = {}
        self.evidence: Evidence | None = None
        distances = watch.offsets - watch.normals @ state[: watch.question.dimensions]
        nearest = int(np.argmin(distances))
        self.distance_now, self.now = float(distances[nearest]), Multiplier(0.0, watch.names[nearest], 1.0)
        # At t = 0 only the nearest face matters; a row that cannot fall below the best possible margin cannot bind.
        first, pushed = first_rows(watch)
        distances = first.offset + first.start @ state
        kept = distances - pushed < distances[nearest] + pushed[nearest]
        kept[: len(watch.names)] = np.arange(len(watch.names)) == nearest
        self.times, self.faces, self.rows = first.times[kept], first.faces[kept], first.thrust[kept]
        self.constant = distances[kept]
        self.blocks = watch.blocks((), np.empty(0))
        if question.goal is not None:
            speed = float(np.abs(state[question.dimensions :]).sum())
            push = question.largest_thrust * question.horizon
            self.rounding += watch.rounding * question.goal.scale * (speed + push)
            self._limit(AT_END, np.full(len(AT_END), question.horizon))
        if question.speed_limit is not None:
            self._limit_speed(question.speed_limit, first.times[:: len(watch.names)])

    def _limit_speed(self, most: float, times: Floats) -> None:
        """Rows for the speed at the first times, and how far below its limit the start is."""
        limit, rounding = speed_limit(most, self.watch.question.dimensions), self.watch.rounding
        left = limit.left(self.state)
        self.rounding += rounding * limit.limit
        self._limit((SPEED,) * len(times), times)
        if left < self.distance_now:
            y = limit.matrix @ self.state
            pull = (1.0 - rounding) * y / max(math.sqrt(float(y @ y)), rounding)
            self.distance_now = limit.limit - float(pull @ y)
            self.now = Multiplier(0.0, SPEED, 1.0, tuple(pull.tolist()))

    def _limit(self, names: tuple[str, ...], times: Floats) -> None:
        self.blocks = self.blocks.and_more(self.watch.blocks(names, times))

    def _stacked(self) -> tuple[Floats, Floats]:
        """Constant and thrust of all rows, those of the blocks last."""
        if not self.blocks.names:
            return self.constant, self.rows
        constant = self.blocks.offset + self.blocks.start @ self.state
        rows = self.blocks.thrust.reshape(-1, self.rows.shape[1])
        return np.concatenate([self.constant, constant.ravel()]), np.concatenate([self.rows, rows])

    def narrow(self, tolerance: float, *, verdict_only: bool = False, share: float = 0.0) -> str:
        """Run rounds until the bracket is narrow enough; returns the reason if the verdict stays open.

        ``share``: for a NO_GO a bracket narrower than this share of its margin is enough.
        """
        fine = False
        for _ in range(MOST_ROUNDS):
            failed = self.round(fine)
            if failed:
                return failed
            decided = self.lower > GUARD or self.upper < -GUARD
            goal = max(tolerance, -share * self.upper) if decided else FINEST
            fine = goal < TOLERANCE and self.upper - self.lower < NARROW
            if self.upper - self.lower <= goal or (decided and verdict_only) or not self.cut(goal):
                break
        return BETWEEN

    def look_closer(self, watch: Watched) -> None:
        """Raise ``lower`` by what ``watch``, which sees more, says of the best flight and of the last one."""
        for thrust in (self.thrust, self.flown):
            if thrust is not None:
                lowest = watch.minima(self.state, thrust).lowest - self.rounding
                if lowest > self.lower:
                    self.lower, self.thrust = lowest, thrust

    def round(self, fine: bool = True) -> str:
        """Solve with the rows so far and watch the flight; the reason if the solver failed, else empty."""
        question = self.watch.question
        self.rounds += 1
        constant, rows = self._stacked()
        scale, norms, within = question.thrust_scale, len(self.blocks.names), question.thrust_set
        found = solve(
            constant,
            rows,
            scale,
            question.channels,
            norms,
            fine=fine,
            within=within,
            components=question.dimensions,
        )
        if found.thrust is None or found.weights is None:
            return f"the solver stopped with {found.status} in round {self.rounds}"
        self.flown, self.load = found.thrust, found.weights[: len(self.times)]
        if found.bound + self.rounding < self.upper:
            self.upper = found.bound + self.rounding
            self.evidence = Evidence(self.times, self.faces, self.blocks, constant, rows, found.weights)
        self.found = self.watch.minima(self.state, found.thrust)
        if self.found.lowest - self.rounding > self.lower:
            self.lower, self.thrust = self.found.lowest - self.rounding, found.thrust
        return ""

    def cut(self, goal: float) -> bool:
        """Add the local minima below the program's margin; False when there is none."""
        low = self.found.values < self.upper - 0.25 * goal
        times, faces = self.found.times[low], self.found.faces[low]
        if not len(times):
            return False
        if self.watch.question.speed_limit is not None:
            fast = faces == len(self.watch.names)
            self._limit((SPEED,) * int(fast.sum()), times[fast])
            times, faces = times[~fast], faces[~fast]
        between, of = self._touches(times, faces)
        if self.rounds <= DROPPING_ROUNDS:
            self._drop()
        cuts = self.watch.cuts(np.concatenate([times, between]), np.concatenate([faces, of]))
        self.times = np.concatenate([self.times, cuts.times])
        self.faces = np.concatenate([self.faces, cuts.faces])
        self.constant = np.concatenate([self.constant, cuts.offset + cuts.start @ self.state])
        self.rows = np.concatenate([self.rows, cuts.thrust])
        return True

    def _drop(self) -> None:
        """Drop rows without weight that are far from binding: the bound does not need them."""
        distance = self.constant + self.rows @ self.flown.ravel()
        near = distance < self.upper + FAR * (self.upper - self.found.lowest)
        kept = near | (self.load > NO_WEIGHT)
        self.times, self.faces = self.times[kept], self.faces[kept]
        self.constant, self.rows = self.constant[kept], self.rows[kept]

    def _touches(self, times: Floats, faces: Ints) -> tuple[Floats, Ints]:
        """Estimate where the best flight touches: a secant on (time of the weight, time of the flight's minimum).

        Weight on one side of the touch makes the flight dip on the other side, closer by a nearly constant factor. The
        dips alone would halve their distance to the touch each round; the secant jumps to it.
        """
        out_times, out_faces = [], []
        reach, loaded = TOUCH_STEPS * self.watch.question.dt, self.load > SOME_WEIGHT
        for time, face in zip(times.tolist(), faces.tolist(), strict=True):
            share = (self.faces == face) & (np.abs(self.times - time) < reach) & loaded
            total = float(self.load[share].sum())
            if total == 0.0:
                continue
            carried = float(self.load[share] @ self.times[share]) / total
            dip = time - carried
            before = self.dips.get(face)
            self.dips[face] = (carried, dip)
            touch = carried + FIRST_GUESS * dip
            if before is not None and before[1] * dip < 0.0:
                touch = carried + dip * (before[0] - carried) / (dip - before[1])
            if min(abs(touch - time), abs(dip)) > SAME_S and 0.0 < touch < self.watch.question.horizon:
                out_times.append(touch)
                out_faces.append(face)
        return np.array(out_times), np.array(out_faces, dtype=np.int64)


def rounding_of(watch: Watched, state: Floats) -> float:
    """What floats may lose of a face's distance (m), from the length that a flight from ``state`` can cover."""
    question = watch.question
    far = speed = 0.0
    for k, entry in enumerate(state.tolist()):
        if k < question.dimensions:
            far += abs(entry)
        else:
            speed += abs(entry)
    reach: float = far + (speed + question.largest_thrust * question.horizon) * question.horizon
    return watch.rounding * reach


@lru_cache(maxsize=64)
def first_rows(watch: Watched) -> tuple[Cuts, Floats]:
    """The initial rows, all faces at some times, and how far (m) thrust can move each row."""
    question = watch.question
    times, faces = np.linspace(0.0, question.horizon, _FIRST_TIMES), np.arange(len(watch.names))
    cuts = watch.cuts(np.repeat(times, len(faces)), np.tile(faces, len(times)))
    by_interval = cuts.thrust.reshape(len(cuts.times), -1, question.channels)
    return cuts, question.thrust_scale * question.thrust_set.support(by_interval)
