"""The manoeuvre behind a GO of `certified`: a Bezier curve in the body frame, then standing at its end for ever."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from safestart.attitude.body_frame import out_of_body
from safestart.closed_form.certified import certify
from safestart.closed_form.family import SMOOTH_STEP, SPANS
from safestart.closed_form.members import BRAKE, stopping_angle
from safestart.closed_form.rates import Rates, rates_of
from safestart.model.scenario import Floats, Rest, Scenario


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """Control points ``start + away`` in metres, body frame, (3,) and (m + 1, 3); ``duration`` in seconds, 0: at once.

    At t the chaser is at the Bezier curve's point t / duration, from ``duration`` on at its last control point, at
    rest. It never leaves the hull of the control points. ``omega`` and ``mean_motion`` in rad/s; the body frame
    coincides with LVLH at t = 0. (``away`` stands apart because a stop may be short against the range.)
    """

    start: Floats
    away: Floats
    duration: float
    omega: float
    mean_motion: float

    def motion(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Position (m), velocity and acceleration in the body frame at ``times`` (T,) >= 0 in seconds, each (T, 3).

        At ``duration`` itself the acceleration is that before the end.
        """
        times = np.asarray(times, dtype=np.float64)
        still = np.zeros((len(times), 3))
        if self.duration == 0.0:
            return still + self.start + self.away[-1], still, still
        degree, going = len(self.away) - 1, (times <= self.duration)[:, None]
        speeds = np.diff(self.away, axis=0) * (degree / self.duration)
        pushes = np.diff(speeds, axis=0) * ((degree - 1) / self.duration)
        share = np.minimum(times / self.duration, 1.0)
        return (
            self.start + _casteljau(self.away, share),
            np.where(going, _casteljau(speeds, share), 0.0),
            np.where(going, _casteljau(pushes, share), 0.0),
        )

    def thrust(self, times: Floats) -> Floats:
        """The thrust acceleration (T, 3) in the body frame, m/s^2, that makes the chaser follow the curve."""
        place, velocity, acceleration = self.motion(times)
        n, angle = self.mean_motion, self.omega * np.asarray(times, dtype=np.float64)
        radial = np.stack([np.cos(angle), -np.sin(angle), np.zeros(len(angle))], axis=-1)
        spin = np.array([0.0, 0.0, self.omega + n])
        turning = 2.0 * np.cross(spin, velocity) + np.cross(spin, np.cross(spin, place))
        gravity = n * n * (3.0 * radial * (radial * place).sum(axis=-1, keepdims=True) - place)
        # CWH's axes turn with n about z, so that z feels the gravity gradient alone.
        return np.asarray(acceleration + turning - gravity)

    def thrust_lvlh(self, times: Floats) -> Floats:
        """The thrust of :meth:`thrust` (T, 3), m/s^2, in LVLH axes."""
        angle = self.omega * np.asarray(times, dtype=np.float64)
        body = self.thrust(times)
        x, y = out_of_body(np.cos(angle), np.sin(angle), body[:, 0], body[:, 1])
        return np.stack([x, y, body[:, 2]], axis=-1)


def manoeuvre_of(scenario: Scenario, point: Floats, rest: Rest = Rest.LVLH) -> Manoeuvre | None:
    """The manoeuvre that certifies one start, body-frame position ``point`` (2,) or (3,) in metres; None if none does.

    Raises ``InvalidInput`` like :func:`certify`.
    """
    point = np.asarray(point, dtype=np.float64)
    found = certify(scenario, point, rest)
    if not bool(found.go):
        return None
    target = scenario.target
    rates = rates_of(scenario, rest)
    start = np.zeros(3)
    start[: len(point)] = point
    member = int(found.member)
    if member == BRAKE:
        away, duration = _braking(rates, start)
    else:
        away, duration = _turning_in(rates, start, member, float(found.drop)), SPANS[member] / rates.rate
    return Manoeuvre(start, away, float(duration), target.tumble_rate, target.mean_motion)


def _braking(rates: Rates, start: Floats) -> tuple[Floats, float]:
    """Degree 2: from p to p (1 - i beta), twice, in 2 beta / omega_t seconds."""
    if rates.speed == 0.0:
        return np.zeros((1, 3)), 0.0
    sway = start[2] * rates.sway
    rho = math.hypot(start[0], start[1]) * rates.scale / math.sqrt(1.0 - sway * sway)
    beta = float(stopping_angle(rates, np.array(rho)))
    stop = beta * np.array([start[1], -start[0], 0.0])
    return np.array([np.zeros(3), stop, stop]), 2.0 * beta / rates.omega


def _turning_in(rates: Rates, start: Floats, member: int, drop: float) -> Floats:
    """Degree 6: the family's member times the start, less the start."""
    turned = (rates.family.shape[:, member] - 1.0) * complex(start[0], start[1])
    return np.stack([turned.real, turned.imag, -start[2] * drop * SMOOTH_STEP], axis=1)


def _casteljau(points: Floats, share: Floats) -> Floats:
    """Points (T, 3) of a Bezier curve, control points (m + 1, 3), at ``share`` (T,) in [0, 1]."""
    level = list(points)
    share = share[:, None]
    while len(level) > 1:
        level = [a + share * (b - a) for a, b in pairwise(level)]
    return np.broadcast_to(level[0], (len(share), 3))
