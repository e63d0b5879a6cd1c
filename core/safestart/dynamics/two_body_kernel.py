"""Two-body motion with J2, compiled: the same equations as :mod:`safestart.dynamics.two_body`, for many flights.

A flight is (12,): target position and velocity, inertial, and the chaser's position and velocity relative to it,
inertial axes, m and m/s. It is integrated by the Runge-Kutta method of order 8 of DOP853 with steps of one length.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import DOP853

from safestart.dynamics.two_body import J2
from safestart.model.orbit import EARTH_RADIUS as RADIUS
from safestart.model.orbit import MU
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

STAGES = np.ascontiguousarray(DOP853.A)
WEIGHTS = np.ascontiguousarray(DOP853.B)
LONGEST_STEP = 60.0
"""s. Over two orbits of 2 h the error of a relative position is below 1e-5 m."""

_LOOKS = 8


def target_at(semi_major_axis: float, eccentricity: float, inclination: float) -> Floats:
    """Inertial state (6,) of a target at its perigee, which lies on the ascending node."""
    radius = semi_major_axis * (1.0 - eccentricity)
    speed = math.sqrt(MU / radius * (1.0 + eccentricity))
    c, s = math.cos(inclination), math.sin(inclination)
    return np.array([radius, 0.0, 0.0, 0.0, speed * c, speed * s])


def target_with(
    semi_major_axis: float, eccentricity: float, inclination: float, perigee: float, anomaly: float
) -> Floats:
    """Inertial state (6,) from osculating elements, m and rad; the ascending node lies on the x axis."""
    parameter = semi_major_axis * (1.0 - eccentricity * eccentricity)
    speed, radius = math.sqrt(MU / parameter), parameter / (1.0 + eccentricity * math.cos(anomaly))
    u = perigee + anomaly
    c, s = math.cos(inclination), math.sin(inclination)
    cross, along = (
        -math.sin(u) - eccentricity * math.sin(perigee),
        math.cos(u) + eccentricity * math.cos(perigee),
    )
    return np.array(
        [
            *(radius * math.cos(u), radius * math.sin(u) * c, radius * math.sin(u) * s),
            *(speed * cross, speed * along * c, speed * along * s),
        ]
    )


@compiled()
def _pull(x: float, y: float, z: float, out: Floats) -> None:
    r2 = x * x + y * y + z * z
    point = -MU / (r2 * math.sqrt(r2))
    bulge = 1.5 * J2 * RADIUS * RADIUS / r2
    ratio = 5.0 * z * z / r2
    across = point * (1.0 + bulge * (1.0 - ratio))
    out[0], out[1], out[2] = across * x, across * y, point * (1.0 + bulge * (3.0 - ratio)) * z


@compiled()
def _rates(y: Floats, drag: float, here: Floats, there: Floats, out: Floats) -> None:
    _pull(y[0], y[1], y[2], here)
    _pull(y[0] + y[6], y[1] + y[7], y[2] + y[8], there)
    for i in range(3):
        out[i], out[3 + i] = y[3 + i], here[i]
        out[6 + i], out[9 + i] = y[9 + i], there[i] - here[i]
    if drag != 0.0:
        speed = math.sqrt((y[3] + y[9]) ** 2 + (y[4] + y[10]) ** 2 + (y[5] + y[11]) ** 2)
        for i in range(3):
            out[9 + i] -= drag * (y[3 + i] + y[9 + i]) / speed


@compiled()
def frame_of(y: Floats, rows: Floats, omega: Floats) -> None:
    """LVLH axes as rows (3, 3) and their angular velocity (3,) in LVLH."""
    r, v = y[:3], y[3:6]
    h = np.array([r[1] * v[2] - r[2] * v[1], r[2] * v[0] - r[0] * v[2], r[0] * v[1] - r[1] * v[0]])
    size, momentum = math.sqrt((r * r).sum()), math.sqrt((h * h).sum())
    for i in range(3):
        rows[0, i], rows[2, i] = r[i] / size, h[i] / momentum
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        rows[1, i] = rows[2, j] * rows[0, k] - rows[2, k] * rows[0, j]
    pull = np.empty(3)
    _pull(r[0], r[1], r[2], pull)
    omega[0] = size * (pull * rows[2]).sum() / momentum
    omega[1], omega[2] = 0.0, momentum / (size * size)


@compiled()
def placed(target: Floats, state: Floats) -> Floats:
    """The flight (12,) of a chaser at the LVLH ``state`` (6,)."""
    rows, omega = np.empty((3, 3)), np.empty(3)
    frame_of(target, rows, omega)
    y = np.empty(12)
    y[:6] = target[:6]
    p = state[:3]
    turn = np.array([-omega[2] * p[1], omega[2] * p[0] - omega[0] * p[2], omega[0] * p[1]])
    for i in range(3):
        y[6 + i] = y[9 + i] = 0.0
        for j in range(3):
            y[6 + i] += rows[j, i] * p[j]
            y[9 + i] += rows[j, i] * (state[3 + j] + turn[j])
    return y


@compiled()
def seen(y: Floats) -> Floats:
    """LVLH state (6,) of a flight."""
    rows, omega = np.empty((3, 3)), np.empty(3)
    frame_of(y, rows, omega)
    out = np.zeros(6)
    for i in range(3):
        for j in range(3):
            out[i] += rows[i, j] * y[6 + j]
            out[3 + i] += rows[i, j] * y[9 + j]
    out[3] += omega[2] * out[1]
    out[4] -= omega[2] * out[0] - omega[0] * out[2]
    out[5] -= omega[0] * out[1]
    return out


@compiled()
def pushed(y: Floats, impulse: Floats) -> None:
    """Change the velocity of a flight by an LVLH ``impulse`` (3,), m/s."""
    rows, omega = np.empty((3, 3)), np.empty(3)
    frame_of(y, rows, omega)
    for i in range(3):
        for j in range(3):
            y[9 + i] += rows[j, i] * impulse[j]


@compiled()
def drifted(
    y: Floats, seconds: float, stages: Floats, weights: Floats, drag: float = 0.0
) -> tuple[Floats, float]:
    """The flight ``seconds`` later, and its least distance to the target meanwhile (cubics between steps).

    ``drag``: deceleration of the chaser by drag less that of the target, m/s^2, against the chaser's inertial velocity.
    """
    count = max(int(math.ceil(seconds / LONGEST_STEP)), 1)  # noqa: RUF046
    h = seconds / count
    state, rates, stage = y.copy(), np.empty((12, 12)), np.empty(12)
    here, there = np.empty(3), np.empty(3)
    least = math.sqrt((state[6:9] * state[6:9]).sum())
    for _ in range(count):
        before = state[6:12].copy()
        for s in range(12):
            stage[:] = state
            for j in range(s):
                a = stages[s, j]
                if a != 0.0:
                    for i in range(12):
                        stage[i] += h * a * rates[j, i]
            _rates(stage, drag, here, there, rates[s])
        for j in range(12):
            for i in range(12):
                state[i] += h * weights[j] * rates[j, i]
        for look in range(1, _LOOKS + 1):
            u = look / _LOOKS
            square = 0.0
            for i in range(3):
                a, b = before[i], state[6 + i]
                p, q = h * before[3 + i], h * state[9 + i]
                at = a + u * (p + u * (3.0 * (b - a) - 2.0 * p - q + u * (2.0 * (a - b) + p + q)))
                square += at * at
            least = min(least, math.sqrt(square))
    return state, least
