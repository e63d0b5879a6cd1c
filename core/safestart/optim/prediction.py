"""Predictions: the states of a linear motion, at nodes and between them, from the start and the thrusts.

The state is (position, velocity), (2 d,), d = 2 (in the plane) or 3; thrusts are held over equal intervals and act in
the motion's axes. Three forms, by the unknowns: every thrust (:class:`Prediction`), one thrust held throughout
(:func:`held_through`), or a box of thrusts of a steady motion, which needs only each thrust's effect
(:func:`responses`).
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import cast

import numpy as np

from safestart.dynamics.motion import ManyMoves, RelativeMotion, SteadyMotion
from safestart.errors import invalid
from safestart.model.scenario import Floats

_KEPT = {2: np.array([0, 1, 3, 4]), 3: np.arange(6)}
"""Components of the state (6,) in d dimensions."""


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """States at the N nodes t_k = k dt, k < N, and within each interval; times count from ``begin`` (s).

    ``free`` (N, 2 d, 2 d) and ``driven`` (N, 2 d, N d): x(t_k) = free_k x0 + driven_k u. ``along`` (2 d, (S+1) 2 d) and
    ``held`` (d, (S+1) 2 d): states at S+1 equally spaced times of an interval from its first state and its thrust.
    A ``steady`` motion uses them for every interval; otherwise each interval has its own, (N, ...).
    """

    motion: RelativeMotion
    steady: SteadyMotion | None
    begin: float
    dt: float
    free: Floats
    driven: Floats
    along: Floats
    held: Floats

    @property
    def steps(self) -> int:
        """N."""
        return len(self.free)

    @property
    def dimensions(self) -> int:
        """d."""
        return int(self.held.shape[-2])

    def until(self, steps: int) -> Prediction:
        """The first ``steps`` intervals alone: views."""
        driven = self.driven[:steps, :, : steps * self.dimensions]
        first = replace(self, free=self.free[:steps], driven=driven)
        if self.steady is not None:
            return first
        return replace(first, along=self.along[:steps], held=self.held[:steps])

    def flight(self, state: Floats, thrust: Floats) -> Floats:
        """States (N, S+1, 2 d) of the flight from ``state`` (2 d,) under ``thrust`` (N, d), both ends included."""
        count, size, _ = self.free.shape
        nodes = (self.free @ state) + (self.driven.reshape(count * size, -1) @ thrust.ravel()).reshape(
            count, -1
        )
        if self.steady is not None:
            flown = nodes @ self.along + thrust @ self.held
        else:
            flown = (nodes[:, None] @ self.along + thrust[:, None] @ self.held)[:, 0]
        out: Floats = flown.reshape(count, -1, size)
        return out

    def position_rows(self, times: Floats, directions: Floats) -> tuple[Floats, Floats]:
        """direction . position at J times as rows over the start, (J, 2 d), and over all thrusts, (J, N d).

        ``times`` (J,) in [0, N dt] seconds, ``directions`` (J, d) in the motion's axes: for a face, its normal as
        turned at that time.
        """
        count, d = self.free.shape[0], directions.shape[1]
        last = np.minimum((times / self.dt).astype(np.int64), count - 1)
        begin = last * self.dt
        if self.steady is not None:
            free, held = self.steady.positions(times - begin, d)
        else:
            free, held = self._positions(begin, times)
        along = (directions[:, None, :] @ free)[:, 0]
        start = (along[:, None, :] @ self.free[last])[:, 0]
        thrust = (along[:, None, :] @ self.driven[last])[:, 0]
        by_interval = thrust.reshape(len(times), count, d)
        by_interval[np.arange(len(times)), last] += (directions[:, None, :] @ held)[:, 0]
        return start, thrust

    def state_rows(self, time: float, matrix: Floats) -> tuple[Floats, Floats]:
        """matrix @ state at one time in [0, N dt] as rows over the start, (P, 2 d), and over all thrusts, (P, N d).

        ``matrix`` (P, 2 d) may weigh positions and velocities.
        """
        d = self.dimensions
        last = min(int(time / self.dt), self.steps - 1)
        free, held = moved(self.motion, self.begin + last * self.dt, self.begin + time, d)
        along = matrix @ free
        thrust: Floats = along @ self.driven[last]
        thrust[:, d * last : d * last + d] += matrix @ held
        return along @ self.free[last], thrust

    def _positions(self, begin: Floats, end: Floats) -> tuple[Floats, Floats]:
        """Position rows (J, d, 2 d) and (J, d, d) from J times to J times within one interval each."""
        d = self.dimensions
        phi, push = moved_many(self.motion, self.begin + begin, self.begin + end, d)
        return phi[:, :d], push[:, :d]


def prediction_of(
    motion: RelativeMotion, dt: float, steps: int, dimensions: int, samples: int, begin: float = 0.0
) -> Prediction:
    """Tables for N = ``steps`` intervals of ``dt`` seconds from ``begin``, with ``samples`` parts each.

    ``dimensions`` 2 leaves out z; raises ``InvalidInput`` where the motion in the plane depends on it.
    """
    steady = motion if isinstance(motion, SteadyMotion) else None
    # A steady motion does not depend on the start time: one entry serves all, and time differences lose nothing.
    begin = begin if steady is None else 0.0
    # Cached separately, because the large tables do not depend on the samples.
    key = cast(Hashable, motion)
    free, driven = _nodes(key, begin, dt, steps, dimensions)
    along, held = _within(key, begin, dt, steps if steady is None else 1, dimensions, samples)
    if steady is not None:
        along, held = along[0], held[0]
    return Prediction(motion, steady, begin, dt, free, driven, along, held)


def held_through(motion: RelativeMotion, begin: float, ends: Floats) -> tuple[Floats, Floats]:
    """Phi (J, 6, 6) and B (J, 6, 3) from ``begin`` to ``ends`` (J,) in seconds: one thrust held all the way."""
    transition = np.array([motion.transition(begin, end) for end in ends])
    return transition, np.array([motion.held(begin, end) for end in ends])


def responses(motion: SteadyMotion, dt: float, steps: int, starts: Floats) -> tuple[Floats, Floats]:
    """States after k = 0 .. N intervals: (N + 1, 2 d, P) of P starts, (N + 1, 2 d, d) of a thrust held once.

    ``starts`` (2 d, P) are columns. A thrust of 1 m/s^2 along axis i over the interval before t = 0 has led to
    ``[k, :, i]`` by t_k: at t_k the thrust of interval j counts with entry k - 1 - j. Powers by doubling.
    """
    size, count = starts.shape
    a, push = moved(motion, 0.0, dt, size // 2)
    powers = np.empty((steps + 1, size, count + size // 2))
    powers[0, :, :count], powers[0, :, count:] = starts, push
    done = 1
    while done <= steps:
        more = min(done, steps + 1 - done)
        np.matmul(a, powers[:more], out=powers[done : done + more])
        a = a @ a
        done += more
    return powers[:, :, :count], powers[:, :, count:]


def moved(motion: RelativeMotion, t0: float, t1: float, d: int) -> tuple[Floats, Floats]:
    """Phi (2 d, 2 d) and B (2 d, d) from t0 to t1, seconds."""
    kept = _KEPT[d]
    return motion.transition(t0, t1)[kept[:, None], kept], motion.held(t0, t1)[kept, :d]


def moved_many(motion: RelativeMotion, begin: Floats, end: Floats, d: int) -> tuple[Floats, Floats]:
    """Phi (J, 2 d, 2 d) and B (J, 2 d, d) from ``begin`` (J,) to ``end`` (J,), s: at once where the motion can."""
    kept = _KEPT[d]
    if isinstance(motion, ManyMoves):
        phi, push = motion.moves(begin, end)
        return phi[:, kept[:, None], kept], push[:, kept, :d]
    parts = [moved(motion, t0, t1, d) for t0, t1 in zip(begin.tolist(), end.tolist(), strict=True)]
    return (
        np.array([phi for phi, _ in parts]).reshape(-1, 2 * d, 2 * d),
        np.array([push for _, push in parts]).reshape(-1, 2 * d, d),
    )


def _interval(motion: RelativeMotion, t0: float, t1: float, d: int) -> tuple[Floats, Floats]:
    """:func:`moved`, after checking that the plane is decoupled."""
    plane = _KEPT[2]
    if d == 2 and (motion.transition(t0, t1)[plane][:, [2, 5]].any() or motion.held(t0, t1)[plane, 2].any()):
        raise invalid("dimensions", "3, for a motion that couples the plane with z", d)
    return moved(motion, t0, t1, d)


@lru_cache(maxsize=4)
def _nodes(motion: RelativeMotion, begin: float, dt: float, steps: int, d: int) -> tuple[Floats, Floats]:
    steady = isinstance(motion, SteadyMotion)
    step, push = _interval(motion, begin, begin + dt, d)
    free = np.empty((steps, 2 * d, 2 * d))
    driven = np.zeros((steps, 2 * d, steps * d))
    free[0] = np.eye(2 * d)
    nodes = begin + dt * np.arange(steps, dtype=np.float64)
    drifts = moved_many(motion, np.full(steps, begin), nodes, d)[0]
    each = None if steady else moved_many(motion, nodes, begin + dt * np.arange(1.0, steps + 1.0), d)
    for k in range(1, steps):
        if each is not None:
            if d == 2:
                _interval(motion, nodes[k - 1], nodes[k], d)
            step, push = each[0][k - 1], each[1][k - 1]
        free[k] = drifts[k]
        driven[k] = step @ driven[k - 1]
        driven[k, :, (k - 1) * d : k * d] = push
    return free, driven


@lru_cache(maxsize=64)
def _within(
    motion: RelativeMotion, begin: float, dt: float, intervals: int, d: int, samples: int
) -> tuple[Floats, Floats]:
    along, held = [], []
    if isinstance(motion, ManyMoves):
        begins = np.repeat(begin + dt * np.arange(intervals, dtype=np.float64), samples + 1)
        parts = np.tile(dt * np.arange(samples + 1) / samples, intervals)
        phi, push = moved_many(motion, begins, begins + parts, d)
        shape = (intervals, samples + 1)
        return (
            phi.reshape(*shape, 2 * d, 2 * d).transpose(0, 3, 1, 2).reshape(intervals, 2 * d, -1),
            push.reshape(*shape, 2 * d, d).transpose(0, 3, 1, 2).reshape(intervals, d, -1),
        )
    for k in range(intervals):
        first = begin + k * dt
        ends = np.array([first + dt * s / samples for s in range(samples + 1)])
        phi, push = moved_many(motion, np.full(samples + 1, first), ends, d)
        along.append(np.hstack(list(phi.swapaxes(1, 2))))
        held.append(np.hstack(list(push.swapaxes(1, 2))))
    return np.array(along), np.array(held)
