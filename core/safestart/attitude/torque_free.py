"""Euler-Poinsot motion in closed form: a rigid body without torque, in inertial axes.

In principal axes (a, b, c), c the axis that the angular velocity circles, moments I, angular momentum H and energy T,

    w = (A cn u, +-B sn u, C dn u),  u = rate t + u(0),  rate^2 = C^2 (Ic - Ib) (Ic - Ia) / (Ia Ib)
    m = Ia |Ia - Ib| A^2 / (Ic |Ib - Ic| C^2),  1 - m = |Ic - Ia| |H^2 - 2 T Ib| / (|Ic - Ib| (|H^2 - 2 T Ia|)).

H^2 - 2 T I is written as a sum without cancellation. The angular momentum is fixed in inertial axes and known in the
body, so two of the attitude's angles follow from w; the third, the precession psi about it, has the rate

    psi' = H (Ia wa^2 + Ib wb^2) / (Ia^2 wa^2 + Ib^2 wb^2) = H / Ic + H (1/Ia - 1/Ic) / (1 + y sn^2),

y = Ic (Ia - Ib) / (Ia (Ib - Ic)). Its integral of the third kind is a steady part and the argument of a theta function
(Whittaker, Analytical Dynamics, section 69): psi = (H / Ia - s l) t + s (arg Theta(u) - arg Theta(u(0))), s the sign of
Ic - Ia and l the slope of the argument at u = 0. Nothing is integrated, so nothing drifts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from safestart.attitude.elliptic import Jacobi, ThetaArgument, first_kind
from safestart.attitude.inertia import checked_inertia, principal_axes, turns
from safestart.attitude.quaternion import matrix_of, unit_quaternion
from safestart.attitude.turning import Bounds, of_rates
from safestart.errors import invalid
from safestart.model.scenario import MAX_TUMBLE_RATE, Floats

Inertia = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class TorqueFree:
    """``inertia`` kg m^2 (body axes), ``attitude`` scalar first and ``body_rate`` rad/s (body axes) at t = 0.

    An attitude relative to inertial axes; :mod:`safestart.attitude.in_lvlh` converts it to LVLH. Raises
    ``InvalidInput`` for an inertia that is not symmetric or not physical (a moment above the sum of the others), a zero
    quaternion, and a rate out of range.
    """

    inertia: Inertia
    attitude: tuple[float, float, float, float]
    body_rate: tuple[float, float, float]
    _course: Any = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        inertia = checked_inertia(self.inertia)
        attitude = unit_quaternion("attitude", self.attitude)
        rate = np.asarray(self.body_rate, dtype=np.float64)
        if rate.shape != (3,) or not np.isfinite(rate).all() or math.hypot(*rate) > MAX_TUMBLE_RATE:
            required = f"three numbers, together at most {MAX_TUMBLE_RATE:g} rad/s"
            raise invalid("body_rate", required, self.body_rate)
        object.__setattr__(self, "inertia", tuple(tuple(row) for row in inertia.tolist()))
        object.__setattr__(self, "attitude", attitude)
        object.__setattr__(self, "body_rate", tuple(rate.tolist()))
        moments, axes = principal_axes(inertia)
        first = axes @ matrix_of(np.array(attitude))
        spin = axes @ rate
        if turns(moments, spin):
            course: Any = _Poinsot(moments, axes, spin, first)
        else:
            course = _Steady(rate, matrix_of(np.array(attitude)))
        object.__setattr__(self, "_course", course)

    def rotation(self, times: Floats) -> Floats:
        """(..., 3, 3): inertial coordinates to body coordinates."""
        out: Floats = self._course.rotation(np.asarray(times, dtype=np.float64))
        return out

    def turn_back(self, times: Floats, after: float) -> Floats:
        """(T, 3, 3): body coordinates ``after`` s later to those at ``times`` (T,).

        As exact at any time within :meth:`polhode_period`, which may be so long that doubles know no attitude there.
        """
        out: Floats = self._course.turn_back(times, after)
        return out

    def angular_velocity(self, times: Floats) -> Floats:
        """(..., 3), rad/s, of the body against inertial axes, in body axes."""
        out: Floats = self._course.angular_velocity(np.asarray(times, dtype=np.float64))
        return out

    def rate_bounds(self) -> tuple[float, float]:
        """The largest angular velocity (rad/s) of all times, and a bound on its derivative (rad/s^2)."""
        most: tuple[float, float] = self._course.bounds
        return most

    def polhode_period(self) -> float:
        """Seconds after which the angular velocity in body axes is the same again; 0 where it never changes."""
        return float(self._course.period)

    @property
    def knots(self) -> Floats:
        """The motion is smooth: it has no knots."""
        return np.empty(0)

    def turn_bounds(self) -> Bounds:
        """From the largest angular velocity: Euler's equations are w' = Q(w, w) with |Q(a, b)| <= |a| |b| / sqrt 2.

        No moment exceeds the sum of the others, so no coefficient of the bilinear Q exceeds 1.
        """
        most, changing = self.rate_bounds()
        first = min(changing, most**2 / math.sqrt(2.0))
        second = math.sqrt(2.0) * first * most
        return of_rates(most, first, second, math.sqrt(2.0) * (second * most + first * first))


class _Steady:
    """A steady turn, about a principal axis or any axis of a ball."""

    def __init__(self, rate: Floats, first: Floats) -> None:
        self.rate, self.first = rate, first
        self.size = math.hypot(*rate)
        self.bounds = (self.size * (1.0 + 1e-15), 0.0)
        self.period = 0.0

    def rotation(self, times: Floats) -> Floats:
        axis = self.rate / self.size if self.size > 0.0 else np.array([0.0, 0.0, 1.0])
        angle = (self.size * times)[..., None, None]
        x, y, z = axis
        along = np.outer(axis, axis)
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        out: Floats = (along + np.cos(angle) * (np.eye(3) - along) - np.sin(angle) * cross) @ self.first
        return out

    def turn_back(self, times: Floats, after: float) -> Floats:
        later = self.rotation(np.full(times.shape, after))
        out: Floats = self.first @ later.swapaxes(-1, -2)
        return out

    def angular_velocity(self, times: Floats) -> Floats:
        return np.broadcast_to(self.rate, (*times.shape, 3))


class _Poinsot:
    """The general motion; ``spin`` (3,) and ``first`` (3, 3) are in principal axes ``axes`` (3, 3)."""

    def __init__(self, moments: Floats, axes: Floats, spin: Floats, first: Floats) -> None:
        order, turn = _circled(moments, spin)
        a, b, c = (float(e) for e in moments[order])
        wa, wb, wc = (float(e) for e in turn @ spin)
        self.axes, first = turn @ axes, turn @ first
        self.moments = np.array([a, b, c])
        # H^2 - 2 T Ic, H^2 - 2 T Ia and H^2 - 2 T Ib up to sign; the first two are sums of terms of one sign.
        over_c = a * abs(a - c) * wa * wa + b * abs(b - c) * wb * wb
        over_a = b * abs(b - a) * wb * wb + c * abs(c - a) * wc * wc
        over_b = abs(a * (a - b) * wa * wa + c * (c - b) * wc * wc)
        self.size_a, self.size_b = math.sqrt(over_c / (a * abs(a - c))), math.sqrt(over_c / (b * abs(b - c)))
        self.size_c = math.sqrt(over_a / (c * abs(c - a)))
        parameter = abs(a - b) * over_c / (abs(b - c) * over_a)
        complement = abs(c - a) * over_b / (abs(c - b) * over_a)
        parameter, complement = (
            (min(parameter, 1.0), 1.0 - min(parameter, 1.0))
            if complement > 0.5
            else (1.0 - complement, complement)
        )
        self.jacobi = Jacobi(parameter, complement)
        self.pace = self.size_c * math.sqrt((c - b) * (c - a) / (a * b))
        self.side = math.copysign(1.0, c - b)
        cosine, sine = wa / self.size_a, self.side * wb / self.size_b
        size = math.hypot(cosine, sine)
        self.begin = first_kind(cosine / size, sine / size, self.jacobi.complement)
        self.momentum = math.hypot(a * wa, b * wb, c * wc)
        y = c * (a - b) / (a * (b - c))
        size = math.sqrt(1.0 + y)
        self.theta = ThetaArgument(
            self.jacobi, first_kind(math.sqrt(y) / size, 1.0 / size, self.jacobi.parameter)
        )
        self.way = math.copysign(1.0, c - a)
        self.precession = self.momentum / a - self.way * self.pace * self.theta.slope
        # (sin, cos) of the third angle up to a factor; it stays defined when the circle shrinks to a point.
        self.third = np.array([math.sqrt(a * abs(b - c)), self.side * math.sqrt(b * abs(a - c))])
        self.first_theta = self.theta.direction(np.array([self.begin]))[0]
        self.frame = self._angles(np.zeros(1))[..., 0].T @ first
        self.bounds = self._bounds()
        self.period = 4.0 * self.jacobi.quarter / abs(self.pace)

    def _bounds(self) -> tuple[float, float]:
        jacobi, (a, b, c) = self.jacobi, (self.size_a, self.size_b, self.size_c)
        fastest = math.sqrt(max(a * a + c * c, b * b + jacobi.complement * c * c))
        # w' = rate (-A sn dn, +-B cn dn, -m C sn cn), and |sn cn| <= 1/2.
        changing = abs(self.pace) * math.hypot(max(a, b), 0.5 * jacobi.parameter * c)
        return fastest * (1.0 + 1e-14), changing * (1.0 + 1e-14)

    def _functions(self, times: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        u = self.begin + self.pace * times
        return (u, *self.jacobi.functions(u))

    def angular_velocity(self, times: Floats) -> Floats:
        _, s, c, d = self._functions(times)
        principal = np.stack([self.size_a * c, self.side * self.size_b * s, self.size_c * d], axis=-1)
        out: Floats = principal @ self.axes
        return out

    def rotation(self, times: Floats) -> Floats:
        angles = self._angles(times.reshape(-1))
        turned = (self.axes.T @ angles.reshape(3, -1)).reshape(3, 3, -1)
        out: Floats = self.frame.T @ turned
        return np.moveaxis(out.reshape(3, 3, *times.shape), (0, 1), (-2, -1))

    def turn_back(self, times: Floats, after: float) -> Floats:
        u = self.begin + self.pace * times
        now = self._angles_at(u, np.zeros(times.shape))
        later = self._angles_at(u + self.pace * after, np.full(times.shape, self.precession * after))
        out: Floats = np.einsum("pi,pkt,qkt,qj->tij", self.axes, now, later, self.axes, optimize=True)
        return out

    def _angles(self, times: Floats) -> Floats:
        """R_z(phi) R_x(theta) R_z(psi), (3, 3, T): the frame with z along the momentum to principal axes."""
        return self._angles_at(self.begin + self.pace * times, self.precession * times)

    def _angles_at(self, u: Floats, angle: Floats) -> Floats:
        """The same at ``u`` (T,), with the precession's steady part ``angle`` (T,)."""
        sn, cn, dn = self.jacobi.functions(u)
        a, b, c = self.moments
        tilt_cos = c * self.size_c * dn
        tilt_sin = _size(a * self.size_a * cn, b * self.size_b * sn)
        size = _size(tilt_cos, tilt_sin)
        tilt_cos, tilt_sin = tilt_cos / size, tilt_sin / size
        third_sin, third_cos = self.third[0] * cn, self.third[1] * sn
        size = _size(third_sin, third_cos)
        third_sin, third_cos = third_sin / size, third_cos / size
        relative = self.theta.direction(u) * self.first_theta.conjugate()
        steady_cos, steady_sin = np.cos(angle), np.sin(angle)
        wobble_cos, wobble_sin = relative.real, self.way * relative.imag
        turn_cos = steady_cos * wobble_cos - steady_sin * wobble_sin
        turn_sin = steady_sin * wobble_cos + steady_cos * wobble_sin
        out = np.empty((3, 3, len(u)))
        out[0, 0] = third_cos * turn_cos - third_sin * tilt_cos * turn_sin
        out[0, 1] = third_cos * turn_sin + third_sin * tilt_cos * turn_cos
        out[0, 2] = third_sin * tilt_sin
        out[1, 0] = -third_sin * turn_cos - third_cos * tilt_cos * turn_sin
        out[1, 1] = -third_sin * turn_sin + third_cos * tilt_cos * turn_cos
        out[1, 2] = third_cos * tilt_sin
        out[2, 0] = tilt_sin * turn_sin
        out[2, 1] = -tilt_sin * turn_cos
        out[2, 2] = tilt_cos
        return out


def _size(x: Floats, y: Floats) -> Floats:
    """Faster than NumPy's, which guards against overflow."""
    out: Floats = np.sqrt(x * x + y * y)
    return out


def _circled(moments: Floats, spin: Floats) -> tuple[list[int], Floats]:
    """Axes in the order (a, b, c), c the circled one, b the middle one; and the turn (3, 3) to them, w_c > 0.

    ``moments`` rise. c is the least where H^2 < 2 T Ib, and the largest otherwise.
    """
    least, middle, most = (float(e) for e in moments)
    # H^2 - 2 T Ib = sum I (I - Ib) w^2.
    above = most * (most - middle) * spin[2] ** 2 - least * (middle - least) * spin[0] ** 2
    order = [0, 1, 2] if above > 0.0 or middle == least else [2, 1, 0]
    if middle == most:
        order = [2, 1, 0]
    turn = np.zeros((3, 3))
    sign = -1.0 if spin[order[2]] < 0.0 else 1.0
    turn[2, order[2]], turn[1, order[1]], turn[0, order[0]] = sign, 1.0, 1.0
    # The sign of a makes odd orders and flipped axes right-handed.
    turn[0, order[0]] = round(float(np.linalg.det(turn)))
    return order, turn
