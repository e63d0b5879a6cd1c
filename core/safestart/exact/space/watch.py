"""One flight in space watched at all times, like :mod:`safestart.exact.watch`, for any attitude, orbit and thrusts.

Between two samples a distance is at least the cubic through value and slope minus h^4 / 384 times a bound on its fourth
derivative; Leibniz's rule gives it from bounds on the derivatives of the faces' normals and of the position.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import lru_cache
from typing import Self

import numpy as np

from safestart.attitude.in_lvlh import InLvlh
from safestart.attitude.turning import SmoothAttitude
from safestart.constraints.cubic import dips
from safestart.exact import speed
from safestart.exact.limits import AT_END, Limit
from safestart.exact.norm_rows import Blocks, stacked
from safestart.exact.space.bends import Rates, of_distance, of_speed, rates_of
from safestart.exact.space.limits import limit_at, speed_room
from safestart.exact.space.question import SpaceQuestion
from safestart.exact.watch import Cuts, Ints, Minima
from safestart.model.scenario import Floats
from safestart.optim.prediction import moved_many, prediction_of

# Samples at most this far apart, in seconds and in radians of turn, so that the cubic's error stays near 1e-7 m.
_LONGEST_SAMPLE_S, _LARGEST_TURN = 0.5, 0.02
_MOST_SAMPLES = 100_000


class SpaceWatch:
    """The margins of one question; made by :func:`space_watch_of`.

    ``normals`` (F, 3) are unit normals in LVLH axes at t = 0, ``offsets`` (F,) m. Thrusts are (N, channels): of a ball
    in m/s^2, else points of the unit set.
    """

    def __init__(self, question: SpaceQuestion) -> None:
        self.question = question
        # The attitude's formulas lose one digit more than a planar turn; the end's speed grows with the turn's.
        self.rounding = 1e-12
        if question.goal is not None:
            self.rounding *= 1.0 + question.goal.scale * question.attitude.rate_bounds()[0]
        faces = question.faces
        given = np.array([face.normal for face in faces])
        lengths = np.sqrt(np.square(given).sum(axis=1))
        self._own = given / lengths[:, None]
        self.offsets = np.array([face.offset for face in faces]) / lengths
        self._levels: Floats = self.offsets
        self.names = tuple(face.name for face in faces)
        self._in_body = np.array([face.frame == "body" for face in faces])
        # Not those of the first sample: a product of one rotation rounds otherwise than one of many.
        self.normals = self._turned(np.zeros(1))[0]
        self.prediction = prediction_of(question.motion, question.dt, question.steps, 3, 1)
        self._sample()
        begins = question.dt * np.arange(question.steps, dtype=np.float64)
        self._pushes: Floats | None = None
        if question.thrust.kind != "ball":
            pushes = np.broadcast_to(question.thrust.pushes, (question.steps, 3, question.channels))
            if question.thrust.frame == "body":
                pushes = question.attitude.rotation(begins).swapaxes(1, 2) @ pushes
            self._pushes = np.ascontiguousarray(pushes)

    def _sample(self) -> None:
        """Points within the intervals, segments between them, and their values that need no flight."""
        question = self.question
        self._turn_bounds = question.attitude.turn_bounds()
        turning = max(bound ** (1.0 / k) for k, bound in enumerate(self._turn_bounds, 1))
        longest = min(_LONGEST_SAMPLE_S, _LARGEST_TURN / turning if turning > 0.0 else math.inf)
        count = max(1, min(math.ceil(question.dt / longest), _MOST_SAMPLES // question.steps))
        parts = question.dt * np.arange(count + 1) / count
        knots = question.attitude.knots
        taus, intervals = [], []
        for k in range(question.steps):
            begin = question.dt * k
            inside = knots[(knots > begin) & (knots < begin + question.dt)] - begin
            own = np.unique(np.concatenate([parts, inside])) if len(inside) else parts
            taus.append(own)
            intervals.append(np.full(len(own), k))
        tau, self._interval = np.concatenate(taus), np.concatenate(intervals)
        times = self._times = question.dt * self._interval + tau
        if question.speed_limit is not None:
            self._pulls = question.orbit.pulls(times)
        segments = np.nonzero(self._interval[1:] == self._interval[:-1])[0]
        self._first, self._last = segments, segments + 1
        self._length = (tau[1:] - tau[:-1])[segments]
        self._begin, self._longest = times[segments], float(self._length.max())
        self._phi, self._held = self._tables(tau, times)
        turn = omega = None
        if self._in_body.any():
            turn, omega = _moving(question.attitude, times)
        self._normals = self._turned(times, turn)
        slopes = self._turning(turn, omega)
        self._slope_first, self._slope_last = slopes[self._first], slopes[self._last]
        if len(knots):
            omega = None if turn is None else question.attitude.angular_velocity(np.nextafter(times, -np.inf))
            self._slope_last = self._turning(turn, omega)[self._last]

    @property
    def intervals(self) -> Ints:
        """The interval (P,) of each sample; a node is a sample of both."""
        return self._interval

    @property
    def sample_times(self) -> Floats:
        """Times (P,) of the samples, s."""
        out: Floats = self._times
        return out

    def until(self, steps: int) -> Self:
        """The watch of the same question with T at ``steps`` intervals, at most its own: views of the same tables."""
        out = copy(self)
        goal = self.question.goal and replace(self.question.goal, earliest=1)
        out.question = replace(self.question, steps=steps, goal=goal)
        out.prediction = self.prediction.until(steps)
        points = int(np.searchsorted(self._interval, steps))
        segments = int(np.searchsorted(self._last, points))
        for name in ("_interval", "_times", "_phi", "_held", "_normals"):
            setattr(out, name, getattr(self, name)[:points])
        for name in ("_first", "_last", "_length", "_begin", "_slope_first", "_slope_last"):
            setattr(out, name, getattr(self, name)[:segments])
        if self.question.speed_limit is not None:
            w, change, tide = self._pulls
            out._pulls = w[:points], change[:points], tide[:points]
        if self._pushes is not None:
            out._pushes = self._pushes[:steps]
        return out

    def _tables(self, tau: Floats, times: Floats) -> tuple[Floats, Floats]:
        """Transition (P, 6, 6) and held thrust (P, 6, 3) from each point's node to the point."""
        if self.question.orbit.circular:
            each, back = np.unique(tau, return_inverse=True)
            phi, held = moved_many(self.question.motion, np.zeros(len(each)), each, 3)
            return phi[back], held[back]
        return moved_many(self.question.motion, times - tau, times, 3)

    def _turned(self, times: Floats, turn: Floats | None = None) -> Floats:
        """Normals (T, F, 3) in LVLH axes; ``turn`` (T, 3, 3) are the attitude's rotations then, if known."""
        out = np.broadcast_to(self._own, (len(times), *self._own.shape))
        if not self._in_body.any():
            return out
        turned: Floats = self._own @ (self.question.attitude.rotation(times) if turn is None else turn)
        return np.where(self._in_body[:, None], turned, out)

    def _turning(self, turn: Floats | None, omega: Floats | None) -> Floats:
        """Rates (P, F, 3) of the normals in LVLH axes at the samples.

        ``turn`` (P, 3, 3) and ``omega`` (P, 3) are the attitude's; None where no face turns with the body.
        """
        if turn is None or omega is None:
            return np.zeros((len(self._times), *self._own.shape))
        moved: Floats = np.cross(omega[:, None, :], self._own[None]) @ turn
        return np.where(self._in_body[:, None], moved, 0.0)

    def accelerations(self, thrust: Floats) -> Floats:
        """Thrusts (N, 3), LVLH, m/s^2, of points (N, channels)."""
        if self._pushes is None:
            return thrust
        out: Floats = (self._pushes @ thrust[:, :, None])[..., 0]
        return out

    def flown(self, state: Floats, thrust: Floats) -> Floats:
        """States (P, 6) at the points of a flight from ``state`` (6,)."""
        u, table = self.accelerations(thrust), self.prediction
        nodes = table.free @ state + (table.driven.reshape(-1, table.driven.shape[-1]) @ u.ravel()).reshape(
            -1, 6
        )
        moved = (self._phi @ nodes[self._interval][:, :, None])[..., 0]
        out: Floats = moved + (self._held @ u[self._interval][:, :, None])[..., 0]
        return out

    def minima(self, state: Floats, thrust: Floats) -> Minima:
        """Local minima and the all-times bound of the flight from ``state`` (6,) under ``thrust`` (N, channels)."""
        flown = self.flown(state, thrust)
        position, velocity = flown[:, :3], flown[:, 3:]
        distance = self._levels - (self._normals @ position[:, :, None])[..., 0]
        closing = (self._normals @ velocity[:, :, None])[..., 0]
        begin = closing[self._first] + (self._slope_first @ position[self._first][:, :, None])[..., 0]
        end = closing[self._last] + (self._slope_last @ position[self._last][:, :, None])[..., 0]
        span, push = self._length[:, None, None], self.accelerations(thrust)
        value = np.stack([distance[self._first], distance[self._last]], axis=1)
        slope = -span * np.stack([begin, end], axis=1)
        taken = self._taken(position)
        if taken is not None:
            value -= np.stack([taken[self._first], taken[self._last]], axis=1)
            slope -= (taken[self._last] - taken[self._first])[:, None]
        limit = self.question.speed_limit
        if limit is not None:
            left, rate = speed_room(limit, self._pulls, flown, push[self._interval])
            ends = np.stack([self._first, self._last], axis=1)
            value = np.concatenate([value, left[ends][..., None]], axis=2)
            slope = np.concatenate([slope, span * rate[ends][..., None]], axis=2)
        low, at = dips(value, slope)
        low, at = low[:, 0], at[:, 0]
        fence = np.full((1, low.shape[1]), np.inf)
        before, after = np.concatenate([fence, low[:-1]]), np.concatenate([low[1:], fence])
        index, face = np.nonzero((low <= before) & (low < after))
        times = self._begin[index] + self._length[index] * at[index, face]
        furthest = math.sqrt(float(np.square(position).sum(axis=1).max()))
        fastest = math.sqrt(float(np.square(velocity).sum(axis=1).max()))
        most = math.sqrt(float(np.square(push).sum(axis=1).max()))
        turning = self._turn_bounds if self._in_body.any() else (0.0, 0.0, 0.0, 0.0)
        rates = rates_of(self.question.orbit, 0.5 * self._longest, furthest, fastest, most)
        share = self._longest**4 / 384.0
        lowest = float(low[:, : len(self.names)].min()) - of_distance(rates, turning) * share
        lowest -= self._taken_between(position, rates)
        if limit is not None:
            slowest = float(low[:, -1].min()) - of_speed(rates) * share
            lowest = min(lowest, float(speed.metres(limit, np.array(slowest))))
            low[:, -1] = speed.metres(limit, low[:, -1])
        if self.question.goal is not None:
            lowest = min(
                lowest, *(self._limit(name, self.question.horizon).left(flown[-1]) for name in AT_END)
            )
        return Minima(lowest, np.minimum(times, self.question.horizon), face, low[index, face])

    def _taken(self, position: Floats) -> Floats | None:  # noqa: ARG002
        """What is taken from the distances (P, F) at the samples, m; a chord bounds it between them. None: nothing."""
        return None

    def _taken_between(self, position: Floats, rates: Rates) -> float:  # noqa: ARG002
        """By how much more is taken between samples, m."""
        return 0.0

    def cuts(self, times: Floats, faces: Ints) -> Cuts:
        """Rows of f_i(t) = offset + start . x0 + thrust . w for pairs of time (J,) in [0, T] and face (J,)."""
        normals, offset = self._across(times, faces)
        start, thrust = self.prediction.position_rows(times, -normals)
        return Cuts(times, faces, offset, start, self._by_channels(thrust))

    def _across(self, times: Floats, faces: Ints) -> tuple[Floats, Floats]:
        """Unit normals (J, 3) in LVLH axes and offsets (J,) of faces (J,) at times (J,)."""
        own, offset = self._planes(times, faces)
        normals = own.copy()
        body = np.nonzero(self._in_body[faces])[0]
        if len(body):
            turn = self.question.attitude.rotation(times[body])
            normals[body] = (own[body][:, None, :] @ turn)[:, 0]
        return normals, offset

    def position_rows(self, time: float, directions: Floats) -> tuple[Floats, Floats]:
        """Of the position at a time (s) along directions (J, 3), LVLH: rows over start (J, 6) and points (J, N C)."""
        start, thrust = self.prediction.position_rows(np.full(len(directions), time), directions)
        return start, self._by_channels(thrust)

    def normals_at(self, time: float) -> Floats:
        """Unit normals (F, 3) of the faces in LVLH axes at a time, s."""
        normals: Floats = self._turned(np.array([time]))[0]
        return normals

    def _planes(self, times: Floats, faces: Ints) -> tuple[Floats, Floats]:  # noqa: ARG002
        """Unit normals (J, 3) in their own frames and offsets (J,) of faces (J,) at times (J,)."""
        return self._own[faces], self.offsets[faces]

    def _by_channels(self, thrust: Floats) -> Floats:
        """Rows (..., N 3) over accelerations as rows (..., N channels) over points."""
        if self._pushes is None:
            return thrust
        by_interval = thrust.reshape(-1, self.question.steps, 3)
        found = np.einsum("jka,kab->jkb", by_interval, self._pushes)
        out: Floats = found.reshape(*thrust.shape[:-1], self.question.steps * self.question.channels)
        return out

    def _limit(self, name: str, time: float) -> Limit:
        question = self.question
        return limit_at(question.attitude, question.goal, question.speed_limit, name, time)

    def blocks(self, names: Sequence[str], times: Floats) -> Blocks:
        """Rows of the norm limits ``names`` (B) at ``times`` (B,)."""
        limits = [self._limit(name, time) for name, time in zip(names, times.tolist(), strict=True)]
        made = stacked(limits, self.prediction, names, times)
        return replace(made, thrust=self._by_channels(made.thrust))


def _moving(attitude: SmoothAttitude, times: Floats) -> tuple[Floats, Floats]:
    """Rotations (T, 3, 3) and angular velocities (T, 3)."""
    if isinstance(attitude, InLvlh):
        return attitude.moving(times)
    return attitude.rotation(times), attitude.angular_velocity(times)


@lru_cache(maxsize=16)
def space_watch_of(question: SpaceQuestion) -> SpaceWatch:
    """The watch of a question, kept between calls."""
    return SpaceWatch(question)
