"""How far members may be from the stated course: angles of the attitude and distances of the chaser, over time.

*Attitude.* With w and w' the angular velocities of two bodies in their own axes, the angle between the bodies grows by
at most |D|, D = w' - w. Without torque w' = Q(w, w), Q quadratic. A member's moments differ by a diagonal matrix E:

    D' = 2 Q(w, D) + Q(D, D) + J^-1 (E w' x w' - E Q(w', w')),  J = I + E,

so |D|' <= m |D| + q |D|^2 + s with m the largest eigenvalue of the symmetric part of 2 Q(w, .), at most sqrt(2/3) of
its Frobenius norm because its trace is 0, q = |Q| and s a bound on the last term. |J^-1| <= (1 - G)^-1 |I^-1| entry by
entry with G = |I^-1| |E| (Neumann).

*Position.* In inertial axes the tide is at most g = 2 mu / r^3, so an acceleration of at most W moves the chaser by at
most y with y'' = g y + W: W (cosh(sqrt(g) t) - 1) / g.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.attitude.in_lvlh import InLvlh
from safestart.attitude.torque_free import TorqueFree
from safestart.attitude.turning import SmoothAttitude
from safestart.errors import invalid
from safestart.exact.space.unknowns import Unknowns
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import Floats

# The checker finds a growth that is larger by less than this share: its steps are coarser.
_COARSER = 1.06
_STEPS_PER_INTERVAL, _TURN_PER_STEP = 8, 0.01
# The checker bounds w on pieces of at most this turn times rate, and of an interval; see proofs.space.attitude.
_HALF_PIECE = 1.2 / 64.0
# Wider than that no corridor has a use for the bound.
_WIDEST = 2.0


def angles(attitude: SmoothAttitude, unknowns: Unknowns, times: Floats, dt: float) -> Floats:
    """Upper bounds (T,), rad, convex and rising over the sorted ``times`` (T,), s from 0 on; all inf if beyond use.

    ``dt`` s is the length of the question's intervals.

    Raises ``InvalidInput`` for an inertia share so wide that the tensor may be singular.
    """
    inner = attitude.inertial if isinstance(attitude, InLvlh) else attitude
    if not isinstance(inner, TorqueFree):
        return unknowns.angle + unknowns.rate * times
    if not (unknowns.rate or unknowns.inertia):
        return np.full(len(times), unknowns.angle)
    body = _Body(inner, unknowns.inertia)
    horizon = float(times[-1])
    size = float(np.linalg.norm(inner.angular_velocity(np.zeros(1))[0]))
    step = min(dt / _STEPS_PER_INTERVAL, _TURN_PER_STEP / max(body.q * size, 1e-9))
    count = max(1, math.ceil(horizon / step))
    knots = np.linspace(0.0, horizon, count + 1)
    h = horizon / count
    rates = body.rates(inner.angular_velocity(knots), dt)
    off, angle = unknowns.rate, unknowns.angle
    found = [angle]
    for m, w, s in zip(*(np.maximum(each[1:], each[:-1]).tolist() for each in rates), strict=True):
        grown = off + h * body.slope(off, m, w, s)
        grown = off + h * body.slope(grown, m, w, s)
        if not grown < _WIDEST:
            return np.full(len(times), math.inf)
        angle += 0.5 * h * (off + grown)
        off = grown
        found.append(angle)
    out: Floats = np.interp(times, knots, np.array(found))
    return out


def drifts(orbit: KeplerOrbit, unknowns: Unknowns, times: Floats) -> Floats:
    """Upper bounds (T,), m, on how far the disturbance moves the chaser within ``times`` (T,), s."""
    g = 2.0 * orbit.mean_motion**2 / (1.0 - orbit.eccentricity) ** 3
    half = 0.5 * math.sqrt(g) * times
    # (cosh(2 x) - 1) / 4 x^2 = (sinh(x) / x)^2 / 2.
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(half > 1e-8, np.sinh(half) / half, 1.0 + half)
    out: Floats = 0.5 * unknowns.disturbance * np.square(times * share)
    return out


class _Body:
    """Bounds on Euler's equations of one inertia tensor and those whose moments differ by ``share``."""

    def __init__(self, body: TorqueFree, share: float) -> None:
        inertia = np.array(body.inertia)
        inverse = np.linalg.inv(inertia)
        cross = np.zeros((3, 3, 3))
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            cross[i, j, k], cross[i, k, j] = 1.0, -1.0
        # I^-1 ((I x) x y), made symmetric in x and y.
        plain = np.einsum("ip,pmn,mj->ijn", inverse, cross, inertia)
        self.tensor = 0.5 * (plain + plain.swapaxes(1, 2))
        self.q = float(np.sqrt(np.square(self.tensor).sum()))
        self._moments = share * np.diag(inertia)
        reach = np.abs(inverse) * self._moments
        if float(reach.sum(axis=1).max()) >= 1.0:
            raise invalid("inertia", "a share by which the inertia cannot become singular", share)
        self._inverse = np.linalg.inv(np.eye(3) - reach) @ np.abs(inverse)
        self._all = float(np.linalg.norm(self._inverse @ self._source(np.ones(3), np.ones(3))))

    def _source(self, w: Floats, turn: Floats) -> Floats:
        """Bounds (..., 3) on E w x w - E q for sizes of the components of w and of q = Q(w, w)."""
        a = self._moments
        x, y, z = np.abs(np.moveaxis(w, -1, 0))
        crossed = np.stack([(a[1] + a[2]) * y * z, (a[2] + a[0]) * z * x, (a[0] + a[1]) * x * y], axis=-1)
        out: Floats = crossed + a * np.abs(turn)
        return out

    def rates(self, w: Floats, dt: float) -> tuple[Floats, Floats, Floats]:
        """m, |w| and the last term's bound (T,) near the angular velocities (T, 3)."""
        matrix = np.einsum("ijk,tk->tij", self.tensor, w)
        both = matrix + matrix.swapaxes(1, 2)
        m = math.sqrt(2.0 / 3.0) * np.sqrt(np.square(both).sum(axis=(1, 2)))
        turn = np.einsum("tij,tj->ti", matrix, w)
        source = np.sqrt(np.square(self._source(w, turn) @ self._inverse.T).sum(axis=1))
        size, quick = np.sqrt(np.square(w).sum(axis=1)), max(self.q, 0.5)
        near = np.sqrt(np.square(turn).sum(axis=1)) * np.minimum(
            _HALF_PIECE / (quick * np.maximum(size, 1e-12)), 0.6 * dt
        )
        m += math.sqrt(8.0 / 3.0) * self.q * near
        return m, size + near, source + max(1.0, self.q) * (2.0 * size + near) * near * self._all

    def slope(self, off: float, m: float, w: float, s: float) -> float:
        """Bound on |D|' where |D| <= ``off``."""
        # With w' = w + D every product of two components grows by at most 2 |w| off + off^2, and Q(w', w') by q of it.
        more = (2.0 * w + off) * off
        return _COARSER * (m * off + self.q * off * off + s + max(1.0, self.q) * more * self._all)
