"""Two-body motion with J2: the truth that CWH approximates, integrated by DOP853.

The target moves in an Earth-centred inertial frame (z along the Earth's axis) under point-mass gravity and J2; the
chaser's position relative to it, rho, has rho'' = g(r + rho) - g(r) + u. LVLH follows the target's true motion: x
radial, z along the orbit's angular momentum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import DOP853

from safestart.errors import invalid
from safestart.model.orbit import EARTH_RADIUS, MU
from safestart.model.scenario import Floats, Target

J2 = 1.08262668e-3

_RELATIVE, _ABSOLUTE = 1e-12, 1e-9


@dataclass(frozen=True, slots=True)
class Orbit:
    """The target's orbit at t = 0: circular speed at ``radius`` m, ``inclination`` and argument of latitude in rad."""

    radius: float
    inclination: float = math.radians(98.0)
    latitude: float = 0.0

    @classmethod
    def of(cls, mean_motion: float, inclination: float = math.radians(98.0)) -> Orbit:
        """Circular orbit of a mean motion (rad/s); raises ``InvalidInput`` for 0 and for an orbit inside the Earth."""
        if not mean_motion > 0.0:
            raise invalid("mean_motion", "more than 0 rad/s for two-body motion", mean_motion)
        radius = (MU / mean_motion**2) ** (1.0 / 3.0)
        if radius < EARTH_RADIUS:
            raise invalid("mean_motion", "an orbit above the Earth's surface", mean_motion)
        return cls(radius, inclination)

    def state(self) -> Floats:
        """Inertial position and velocity of the target (6,) at t = 0."""
        cu, su = math.cos(self.latitude), math.sin(self.latitude)
        ci, si = math.cos(self.inclination), math.sin(self.inclination)
        out = np.array([cu, su * ci, su * si]), np.array([-su, cu * ci, cu * si])
        return np.concatenate([self.radius * out[0], math.sqrt(MU / self.radius) * out[1]])


def gravity(position: Floats) -> Floats:
    """Acceleration (3,) at an inertial position (3,), m: point mass and J2."""
    x, y, z = position
    r2 = x * x + y * y + z * z
    r = math.sqrt(r2)
    point = -MU / (r2 * r)
    bulge = 1.5 * J2 * EARTH_RADIUS * EARTH_RADIUS / r2
    ratio = 5.0 * z * z / r2
    across = point * (1.0 + bulge * (1.0 - ratio))
    return np.array([across * x, across * y, point * (1.0 + bulge * (3.0 - ratio)) * z])


def axes(target: Floats) -> tuple[Floats, Floats]:
    """LVLH axes as rows (3, 3), inertial, and their angular velocity (3,) in LVLH, of a target state (6,)."""
    r, v = target[:3], target[3:]
    h = np.cross(r, v)
    size, momentum = math.sqrt(r @ r), math.sqrt(h @ h)
    x, z = r / size, h / momentum
    rows = np.array([x, np.cross(z, x), z])
    # The axes turn about x because a force out of the plane tilts the orbit.
    return rows, np.array([size * float(gravity(r) @ z) / momentum, 0.0, momentum / (size * size)])


@dataclass(frozen=True, slots=True)
class TwoBody:
    """The motion of a chaser near a target on ``orbit``."""

    orbit: Orbit

    def start(self, state: Floats) -> TwoBodyFlight:
        """A chaser at the LVLH state (6,) at t = 0."""
        return TwoBodyFlight(self.orbit, state)


def two_body_of(target: Target) -> TwoBody:
    """The motion near a scenario's target, on a circular orbit of its mean motion."""
    return TwoBody(Orbit.of(target.mean_motion))


class TwoBodyFlight:
    """A chaser near a target from an LVLH state (6,), m and m/s, on."""

    def __init__(self, orbit: Orbit, state: Floats) -> None:
        target = orbit.state()
        rows, omega = axes(target)
        position = rows.T @ state[:3]
        velocity = rows.T @ (state[3:] + np.cross(omega, state[:3]))
        self.state = np.array(state, dtype=np.float64)
        self._all = np.concatenate([target, position, velocity])

    def push(self, impulse: Floats) -> None:
        """Change the velocity at once by ``impulse`` (3,), m/s, in LVLH axes."""
        rows, _omega = axes(self._all[:6])
        self._all[9:] += rows.T @ impulse
        self.state = _seen(self._all)

    def fly(self, thrust: Floats, times: Floats) -> Floats:
        """LVLH states (T, 6) at ``times``, the first of which is now, with ``thrust`` (3,) held in LVLH axes."""

        def rates(_: float, y: Floats) -> Floats:
            here = gravity(y[:3])
            rows, _omega = axes(y[:6])
            pull = gravity(y[:3] + y[6:9]) - here + rows.T @ thrust
            return np.concatenate([y[3:6], here, y[9:12], pull])

        solver = DOP853(
            rates, float(times[0]), self._all, float(times[-1]), rtol=_RELATIVE, atol=_ABSOLUTE, max_step=2.0
        )
        out = [self._all]
        while solver.status == "running":
            solver.step()
            dense = solver.dense_output()
            while len(out) < len(times) and times[len(out)] <= solver.t:
                out.append(solver.y if times[len(out)] == solver.t else dense(times[len(out)]))
        if solver.status != "finished":
            self.state = np.full(6, np.nan)
            return np.full((len(times), 6), np.nan)
        self._all = np.array(solver.y)
        states = np.array([_seen(y) for y in out])
        self.state = states[-1].copy()
        return states


def _seen(y: Floats) -> Floats:
    """LVLH state (6,) of the chaser."""
    rows, omega = axes(y[:6])
    position = rows @ y[6:9]
    return np.concatenate([position, rows @ y[9:12] - np.cross(omega, position)])
