"""One flight watched at all times: the smallest face distance in continuous time, and the rows that cut it off.

Between two samples h seconds apart a face distance f is enclosed by the cubic through f and f' at both: the distance
between them is at most h^4 / 384 times the largest |f''''|. The cubic's minimum is closed-form, so a handful of samples
per interval give a bound that holds at all times (in exact arithmetic; floats add about 1e-12 m).

Everything but the turn of the faces depends on (n, dt, steps, d) alone and is kept; a question adds cosines and sines.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from safestart.certificates.motion import NodeTables, held_displacement, motion_tables
from safestart.certificates.question import Question
from safestart.corridor import corridor_of
from safestart.scenario import Floats

Ints = np.ndarray[tuple[int, ...], np.dtype[np.int64]]

# Samples at most this far apart, in seconds and in radians of tumble: the cubic's error stays near 1e-7 m.
_LONGEST_SAMPLE_S, _LARGEST_TURN = 0.5, 0.02
_MOST_SAMPLES = 200_000


@dataclass(frozen=True, slots=True)
class Minima:
    """What a flight's face distances come down to: a bound for all times and the local minima (times in s, m)."""

    lowest: float
    times: Floats
    faces: Ints
    values: Floats


@dataclass(frozen=True, slots=True)
class Cuts:
    """Rows of the linear model at (time, face) pairs: ``start`` (J, 2 d), ``thrust`` (J, N d), ``offset`` (J,)."""

    times: Floats
    faces: Ints
    offset: Floats
    start: Floats
    thrust: Floats


class Watch:
    """The face distances of one question; made by :func:`watch_of`."""

    def __init__(self, question: Question) -> None:
        target = question.scenario.target
        self.question = question
        self.rate, self.mean_motion = target.tumble_rate, target.mean_motion
        longest = min(_LONGEST_SAMPLE_S, _LARGEST_TURN / self.rate if self.rate > 0.0 else math.inf)
        samples = math.ceil(question.dt / longest)
        self.samples = max(1, min(samples, _MOST_SAMPLES // question.steps))
        self.step = question.dt / self.samples
        self.tables: NodeTables = motion_tables(
            self.mean_motion, question.dt, question.steps, question.dimensions, self.samples
        )
        nodes = question.dt * np.arange(question.steps)[:, None]
        self.times = nodes + self.step * np.arange(self.samples + 1)[None, :]
        angle = self.rate * self.times
        self.cosine, self.sine = np.cos(angle), np.sin(angle)
        corridor = corridor_of(question.scenario.corridor, question.dimensions)
        self.normals = corridor.normals / corridor.lengths[:, None]
        self.offsets = corridor.offsets / corridor.lengths
        self.names = corridor.faces

    def minima(self, state: Floats, thrust: Floats) -> Minima:
        """Local minima and the all-times bound of the flight from ``state`` (2 d,) under ``thrust`` (N, d) in m/s^2."""
        d, h = self.question.dimensions, self.step
        flown = self.tables.flight(state, thrust)
        position, speed = self._body(flown[..., :d], flown[..., d:])
        value = self.offsets - position @ self.normals.T
        slope = speed @ (-h * self.normals.T)
        left, right = value[:, :-1], value[:, 1:]
        begin, end = slope[:, :-1], slope[:, 1:]
        rise = right - left
        square = 3.0 * rise - 2.0 * begin - end
        root = np.sqrt(np.maximum(square * square - 3.0 * (begin + end - 2.0 * rise) * begin, 0.0))
        below = square + root
        # -begin / (square + root) is the cubic's minimum; it lies in the sample when 0 < -begin < square + root.
        inside = (begin < 0.0) & (below > -begin)
        at = np.where(inside, -begin / np.where(inside, below, 1.0), np.where(right < left, 1.0, 0.0))
        low = left + at * (begin + at * (square + at * (begin + end - 2.0 * rise)))
        faces = low.shape[-1]
        low, at = low.reshape(-1, faces), at.reshape(-1, faces)
        fence = np.full((1, faces), np.inf)
        before, after = np.concatenate([fence, low[:-1]]), np.concatenate([low[1:], fence])
        index, face = np.nonzero((low <= before) & (low < after))
        times = self.times[:, :-1].ravel()[index] + h * at[index, face]
        lowest = float(low.min()) - self._curvature(flown, thrust) * h**4 / 384.0
        return Minima(lowest, np.minimum(times, self.question.horizon), face, low[index, face])

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows of f_i(t) = offset + start . x0 + thrust . u for pairs of time (J,) in [0, T] and face (J,)."""
        d, count, dt = self.question.dimensions, self.question.steps, self.question.dt
        last = np.minimum((times / dt).astype(np.int64), count - 1)
        free, held = held_displacement(self.mean_motion, times - last * dt, d)
        cosine, sine = np.cos(self.rate * times), np.sin(self.rate * times)
        body = self.normals[faces]
        normal = -body
        normal[:, 0] = -(cosine * body[:, 0] - sine * body[:, 1])
        normal[:, 1] = -(sine * body[:, 0] + cosine * body[:, 1])
        along = (normal[:, None, :] @ free)[:, 0]
        start = (along[:, None, :] @ self.tables.free[last])[:, 0]
        thrust = (along[:, None, :] @ self.tables.driven[last])[:, 0]
        columns = d * last[:, None] + np.arange(d)
        thrust[np.arange(len(times))[:, None], columns] += (normal[:, None, :] @ held)[:, 0]
        return Cuts(times, faces, self.offsets[faces], start, thrust)

    def _body(self, position: Floats, speed: Floats) -> tuple[Floats, Floats]:
        """Body-frame position and its rate, R(-wt) p and R(-wt) (v - w x p)."""
        c, s, w = self.cosine, self.sine, self.rate
        x, y = position[..., 0], position[..., 1]
        vx, vy = speed[..., 0] + w * y, speed[..., 1] - w * x
        turned, rate = position.copy(), speed.copy()
        turned[..., 0], turned[..., 1] = c * x + s * y, c * y - s * x
        rate[..., 0], rate[..., 1] = c * vx + s * vy, c * vy - s * vx
        return turned, rate

    def _curvature(self, flown: Floats, thrust: Floats) -> float:
        """Bound on |f''''| between the samples: Leibniz over the turn, CWH for the derivatives of the position."""
        d, n, w = self.question.dimensions, self.mean_motion, self.rate
        half = 0.5 * self.step
        furthest = math.sqrt(float(np.square(flown[..., :d]).sum(axis=-1).max()))
        fastest = math.sqrt(float(np.square(flown[..., d:]).sum(axis=-1).max()))
        push = math.sqrt(float(np.square(thrust).sum(axis=-1).max()))
        # |a| <= 3 n^2 r + 2 n v + u, carried over half a sample from the nearer end.
        gain = half * (2.0 * n + 3.0 * n * n * half)
        if gain >= 1.0:
            return math.inf
        v = (fastest + half * (3.0 * n * n * furthest + push)) / (1.0 - gain)
        r = furthest + half * v
        a = 3.0 * n * n * r + 2.0 * n * v + push
        jerk = 3.0 * n * n * v + 2.0 * n * a
        snap = 3.0 * n * n * a + 2.0 * n * jerk
        return w**4 * r + 4.0 * w**3 * v + 6.0 * w * w * a + 4.0 * w * jerk + snap


@lru_cache(maxsize=16)
def watch_of(question: Question) -> Watch:
    """The watch of a question, kept between calls."""
    return Watch(question)
