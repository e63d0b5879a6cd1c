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

from safestart.attitude.body_frame import into_body
from safestart.constraints.corridor import corridor_of
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
_CLOSER = 4


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

    ``phase`` is the angle (rad) by which the corridor has turned at the question's t = 0, ``closer`` how many times as
    many samples as usual there are.
    """

    rounding = 1e-13
    """Some hundred roundings."""

    def __init__(self, question: Question, phase: float = 0.0, closer: int = 1) -> None:
        target = question.scenario.target
        self.question, self.phase = question, phase
        self.rate, self.mean_motion = target.tumble_rate, target.mean_motion
        longest = min(_LONGEST_SAMPLE_S, _LARGEST_TURN / self.rate if self.rate > 0.0 else math.inf)
        samples = closer * math.ceil(question.dt / longest)
        self.samples = max(1, min(samples, _MOST_SAMPLES // question.steps))
        self.step = question.dt / self.samples
        self.prediction = prediction_of(
            Cwh(self.mean_motion), question.dt, question.steps, question.dimensions, self.samples
        )
        nodes = question.dt * np.arange(question.steps)[:, None]
        self.times = nodes + self.step * np.arange(self.samples + 1)[None, :]
        self.begins = self.times[:, :-1].ravel()
        self.pushed = np.ascontiguousarray(self.prediction.driven[1:, :, : question.dimensions])
        angle = phase + self.rate * self.times
        self.cosine, self.sine = np.cos(angle), np.sin(angle)
        corridor = corridor_of(question.scenario.corridor, question.dimensions)
        self.normals = corridor.normals / corridor.lengths[:, None]
        self.offsets = corridor.offsets / corridor.lengths
        self.names = corridor.names

    def closer(self) -> Watch:
        """The watch of the same question that looks four times as often: its bounds lie 256 times closer."""
        return Watch(self.question, self.phase, _CLOSER)

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
        # Imported with the first flight, because Numba takes a second to load.
        from safestart.exact.kernels.minima import (
            below_cubics,
            derivative_bounds,
            flight_minima,
            local_minima,
        )

        table, question, limit = self.prediction, self.question, self.question.speed_limit
        low, at, last, *most = flight_minima(
            state,
            thrust,
            table.free,
            table.along,
            table.held,
            self.cosine,
            self.sine,
            self.normals,
            self.offsets,
            self.rate,
            self.mean_motion,
            self.step,
            limit or 0.0,
        )
        bounds = derivative_bounds(self.mean_motion, self.step, *most)
        lowest = float(low[:, : len(self.names)].min()) - below_cubics(self.rate, self.step, bounds)
        if limit is not None:
            lost = speed.bend(self.mean_motion, bounds) * self.step**4 / 384.0
            lowest = min(lowest, float(speed.metres(limit, low[:, -1].min() - lost)))
            low[:, -1] = speed.metres(limit, low[:, -1])
        if question.goal is not None:
            ends = [limit_at(question, name, question.horizon) for name in AT_END]
            lowest = min(lowest, *(end.left(last) for end in ends))
        times, faces, values = local_minima(low, at, self.begins[: len(low)], self.step)
        return Minima(lowest, np.minimum(times, question.horizon), faces, values)

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows of f_i(t) = offset + start . x0 + thrust . u for pairs of time (J,) in [0, T] and face (J,)."""
        from safestart.exact.kernels.rows import face_rows

        start, thrust = face_rows(
            times,
            faces,
            self.normals,
            self.phase,
            self.rate,
            self.mean_motion,
            self.question.dt,
            self.prediction.free,
            self.pushed,
        )
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
        from safestart.exact.kernels.minima import below_cubics, derivative_bounds

        push = math.sqrt(float(np.square(thrust).sum(axis=-1).max()))
        bounds = derivative_bounds(self.mean_motion, self.step, furthest, fastest, push)
        return float(below_cubics(self.rate, self.step, bounds))


@lru_cache(maxsize=64)
def watch_of(question: Question, phase: float = 0.0) -> Watch:
    """The watch of a question, kept between calls."""
    return Watch(question, phase)
