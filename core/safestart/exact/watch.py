"""One flight watched at all times: the smallest margin in continuous time, and the rows that cut the flight off.

Between two samples h seconds apart a face distance f is enclosed by the cubic through f and f' at both: the distance
between them is at most h^4 / 384 times the largest |f''''|. The cubic's minimum is closed-form, so a handful of samples
per interval give a bound that holds at all times (in exact arithmetic; floats add about 1e-12 m).

Everything but the turn of the faces depends only on (n, dt, steps, d) and is cached; a question adds cosines and sines.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from safestart.attitude.body_frame import into_body, out_of_body
from safestart.constraints.corridor import corridor_of
from safestart.constraints.cubic import dips
from safestart.dynamics.cwh import Cwh
from safestart.exact import speed
from safestart.exact.limits import AT_END, limit_at
from safestart.exact.norm_rows import Blocks, blocks
from safestart.exact.question import Question
from safestart.model.scenario import Floats
from safestart.optim.prediction import prediction_of

Ints = np.ndarray[tuple[int, ...], np.dtype[np.int64]]

# Samples at most this far apart, in seconds and in radians of tumble: the cubic's error stays near 1e-7 m.
_LONGEST_SAMPLE_S, _LARGEST_TURN = 0.5, 0.02
_MOST_SAMPLES = 200_000


@dataclass(frozen=True, slots=True)
class Minima:
    """A flight's margins: a bound for all times and the local minima (times in s, m).

    With a speed limit, the index after the last face stands for its margin.
    """

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
    """The margins of one question; made by :func:`watch_of`.

    ``phase`` is the angle (rad) by which the corridor has turned at the question's t = 0.
    """

    rounding = 1e-13
    """Some hundred roundings."""

    def __init__(self, question: Question, phase: float = 0.0) -> None:
        target = question.scenario.target
        self.question, self.phase = question, phase
        self.rate, self.mean_motion = target.tumble_rate, target.mean_motion
        longest = min(_LONGEST_SAMPLE_S, _LARGEST_TURN / self.rate if self.rate > 0.0 else math.inf)
        samples = math.ceil(question.dt / longest)
        self.samples = max(1, min(samples, _MOST_SAMPLES // question.steps))
        self.step = question.dt / self.samples
        self.prediction = prediction_of(
            Cwh(self.mean_motion), question.dt, question.steps, question.dimensions, self.samples
        )
        nodes = question.dt * np.arange(question.steps)[:, None]
        self.times = nodes + self.step * np.arange(self.samples + 1)[None, :]
        angle = phase + self.rate * self.times
        self.cosine, self.sine = np.cos(angle), np.sin(angle)
        corridor = corridor_of(question.scenario.corridor, question.dimensions)
        self.normals = corridor.normals / corridor.lengths[:, None]
        self.offsets = corridor.offsets / corridor.lengths
        self.names = corridor.names

    def until(self, steps: int) -> Watch:
        """The watch of the same question with T at ``steps`` intervals, at most its own: views of the same tables."""
        out = copy(self)
        goal = self.question.goal and replace(self.question.goal, earliest=1)
        out.question = replace(self.question, steps=steps, goal=goal)
        out.prediction = self.prediction.until(steps)
        out.times, out.cosine, out.sine = self.times[:steps], self.cosine[:steps], self.sine[:steps]
        return out

    def minima(self, state: Floats, thrust: Floats) -> Minima:
        """Local minima and the all-times bound of the flight from ``state`` (2 d,) under ``thrust`` (N, d) in m/s^2."""
        d, h = self.question.dimensions, self.step
        flown = self.prediction.flight(state, thrust)
        value, slope = self.along_normals(flown)
        value += self.offsets
        limit = self.question.speed_limit
        if limit is not None:
            left, closing = speed.room(limit, self.mean_motion, h, flown, thrust)
            value, slope = np.concatenate([value, left], axis=-1), np.concatenate([slope, closing], axis=-1)
        low, at = dips(value, slope)
        faces = low.shape[-1]
        low, at = low.reshape(-1, faces), at.reshape(-1, faces)
        fence = np.full((1, faces), np.inf)
        before, after = np.concatenate([fence, low[:-1]]), np.concatenate([low[1:], fence])
        index, face = np.nonzero((low <= before) & (low < after))
        times = self.times[:, :-1].ravel()[index] + h * at[index, face]
        furthest = math.sqrt(float(np.square(flown[..., :d]).sum(axis=-1).max()))
        fastest = math.sqrt(float(np.square(flown[..., d:]).sum(axis=-1).max()))
        lowest = float(low[:, : len(self.names)].min()) - self.between(furthest, fastest, thrust)
        if limit is not None:
            lost = speed.bend(self.mean_motion, self._bounds(furthest, fastest, thrust)) * h**4 / 384.0
            lowest = min(lowest, float(speed.metres(limit, low[:, -1].min() - lost)))
            low[:, -1] = speed.metres(limit, low[:, -1])
        if self.question.goal is not None:
            ends = [limit_at(self.question, name, self.question.horizon) for name in AT_END]
            lowest = min(lowest, *(end.left(flown[-1, -1]) for end in ends))
        return Minima(lowest, np.minimum(times, self.question.horizon), face, low[index, face])

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows of f_i(t) = offset + start . x0 + thrust . u for pairs of time (J,) in [0, T] and face (J,)."""
        angle = self.phase + self.rate * times
        cosine, sine = np.cos(angle), np.sin(angle)
        body = self.normals[faces]
        normal = -body
        x, y = out_of_body(cosine, sine, body[:, 0], body[:, 1])
        normal[:, 0], normal[:, 1] = -x, -y
        start, thrust = self.prediction.position_rows(times, normal)
        return Cuts(times, faces, self.offsets[faces], start, thrust)

    def blocks(self, names: Sequence[str], times: Floats) -> Blocks:
        """Rows of the norm limits ``names`` (B) at ``times`` (B,)."""
        return blocks(self.question, self.prediction, names, times)

    def along_normals(self, flown: Floats) -> tuple[Floats, Floats]:
        """-normal . position in the body frame, (N, S+1, F) in m, and its rate times the sample's length.

        ``flown`` (N, S+1, 2 d) is a flight or, the map being linear, a difference of flights.
        """
        d = self.question.dimensions
        position, speed = self._body(flown[..., :d], flown[..., d:])
        return position @ -self.normals.T, speed @ (-self.step * self.normals.T)

    def _body(self, position: Floats, speed: Floats) -> tuple[Floats, Floats]:
        """Body-frame position and its rate, R(-wt) p and R(-wt) (v - w x p)."""
        c, s, w = self.cosine, self.sine, self.rate
        x, y = position[..., 0], position[..., 1]
        vx, vy = speed[..., 0] + w * y, speed[..., 1] - w * x
        turned, rate = position.copy(), speed.copy()
        turned[..., 0], turned[..., 1] = into_body(c, s, x, y)
        rate[..., 0], rate[..., 1] = into_body(c, s, vx, vy)
        return turned, rate

    def between(self, furthest: float, fastest: float, thrust: Floats) -> float:
        """How far (m) a distance may lie below the cubics: h^4 max |f''''| / 384.

        Leibniz over the turn, CWH for the derivatives of the position; ``furthest`` (m) and ``fastest`` (m/s) hold at
        the samples.
        """
        w, (r, v, a, jerk, snap) = self.rate, self._bounds(furthest, fastest, thrust)
        curvature = w**4 * r + 4.0 * w**3 * v + 6.0 * w * w * a + 4.0 * w * jerk + snap
        return curvature * self.step**4 / 384.0

    def _bounds(
        self, furthest: float, fastest: float, thrust: Floats
    ) -> tuple[float, float, float, float, float]:
        """Bounds between the samples on |r| and its first four derivatives in LVLH."""
        n = self.mean_motion
        half = 0.5 * self.step
        push = math.sqrt(float(np.square(thrust).sum(axis=-1).max()))
        # |a| <= 3 n^2 r + 2 n v + u, carried over half a sample from the nearer end.
        gain = half * (2.0 * n + 3.0 * n * n * half)
        if gain >= 1.0:
            return (math.inf,) * 5
        v = (fastest + half * (3.0 * n * n * furthest + push)) / (1.0 - gain)
        r = furthest + half * v
        a = 3.0 * n * n * r + 2.0 * n * v + push
        jerk = 3.0 * n * n * v + 2.0 * n * a
        return r, v, a, jerk, 3.0 * n * n * a + 2.0 * n * jerk


@lru_cache(maxsize=64)
def watch_of(question: Question, phase: float = 0.0) -> Watch:
    """The watch of a question, kept between calls."""
    return Watch(question, phase)
