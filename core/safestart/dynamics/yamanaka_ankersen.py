"""Relative motion near a target on an elliptic orbit: Yamanaka and Ankersen's transition, thrust held in time.

Linearised about the orbit, with w = nu' the rate of LVLH and g = mu / r^3,

    x'' = 2 w y' + w' y + (w^2 + 2 g) x + u_x,  y'' = -2 w x' - w' x + (w^2 - g) y + u_y,  z'' = -g z + u_z.

Yamanaka and Ankersen (Journal of Guidance, Control and Dynamics 25(1), 2002) solve it in closed form with the true
anomaly, rho = 1 + e cos nu and J = k^2 (t - t0), k^2 = nu' / rho^2; their axes are (y, -z, -x) of ours. The effect of a
thrust held in LVLH axes is the integral of the transition, by Gauss's rule: the integrand is analytic, and short panels
of ten points leave only rounding errors.

Over a small turn of LVLH their form loses digits, because the drift of a few seconds is a small difference of large
terms. Such intervals use Taylor series in time (``elliptic_series``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.dynamics.elliptic_series import LARGEST_TURN, series
from safestart.dynamics.motion import ManyMoves
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import Floats

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(10)
_PANEL = 0.3
"""Largest turn of LVLH over a panel, rad."""


@dataclass(frozen=True)
class YamanakaAnkersen(ManyMoves):
    """The motion near a target on ``orbit``; on a circular one it is CWH."""

    orbit: KeplerOrbit

    def moves(self, begin: Floats, end: Floats) -> tuple[Floats, Floats]:
        """Phi (J, 6, 6) and the effect of held thrust (J, 6, 3) from ``begin`` (J,) to ``end`` (J,), s."""
        if float(np.abs(end - begin).max(initial=0.0)) * self.orbit.rate_bounds()[0] <= LARGEST_TURN:
            return series(self.orbit, begin, end - begin)
        return self._transitions(begin, end), self._held(begin, end)

    def transition(self, t0: float, t1: float) -> Floats:
        """Phi(t1, t0), (6, 6)."""
        out: Floats = self.moves(np.array([t0]), np.array([t1]))[0][0]
        return out

    def held(self, t0: float, t1: float) -> Floats:
        """(6, 3): the effect at t1 of one unit of thrust, held in LVLH axes from t0 to t1."""
        out: Floats = self.moves(np.array([t0]), np.array([t1]))[1][0]
        return out

    def _transitions(self, begin: Floats, end: Floats) -> Floats:
        e = self.orbit.eccentricity
        first, last = (self.orbit.true_anomaly + self.orbit.turned(t) for t in (begin, end))
        # k^2 = nu' / rho^2, the same at all times.
        pace = self.orbit.mean_motion / (1.0 - e * e) ** 1.5
        there = _fundamental(last, e, pace * (end - begin))
        back = _inverse(first, e)
        plane = there @ back
        across = _out_of_plane(last) @ _out_of_plane(first).swapaxes(1, 2)
        return _dimensional(plane, across, first, last, e, pace)

    def _held(self, begin: Floats, end: Floats) -> Floats:
        longest = float(np.abs(end - begin).max(initial=0.0)) * self.orbit.rate_bounds()[0]
        panels = max(1, math.ceil(longest / _PANEL))
        shares = ((np.arange(panels)[:, None] + 0.5 + 0.5 * _POINTS) / panels).ravel()
        weights = np.tile(0.5 * _WEIGHTS / panels, panels)
        span = end - begin
        times = begin[:, None] + span[:, None] * shares
        ends = np.repeat(end, len(shares))
        moved = self._transitions(times.ravel(), ends).reshape(len(begin), len(shares), 6, 6)[..., 3:]
        out: Floats = np.einsum("jgab,g->jab", moved, weights) * span[:, None, None]
        return out


def _fundamental(nu: Floats, e: float, j: Floats) -> Floats:
    """(J, 4, 4) of (along, nadir, along', nadir'), scaled by rho and differentiated by nu."""
    sin, cos = np.sin(nu), np.cos(nu)
    rho = 1.0 + e * cos
    s, c = rho * sin, rho * cos
    s1, c1 = cos + e * np.cos(2.0 * nu), -(sin + e * np.sin(2.0 * nu))
    out = np.zeros((len(nu), 4, 4))
    out[:, 0, 0] = 1.0
    out[:, 0, 1], out[:, 0, 2], out[:, 0, 3] = -c * (1.0 + 1.0 / rho), s * (1.0 + 1.0 / rho), 3.0 * rho**2 * j
    out[:, 1, 1], out[:, 1, 2], out[:, 1, 3] = s, c, 2.0 - 3.0 * e * s * j
    out[:, 2, 1], out[:, 2, 2], out[:, 2, 3] = 2.0 * s, 2.0 * c - e, 3.0 * (1.0 - 2.0 * e * s * j)
    out[:, 3, 1], out[:, 3, 2], out[:, 3, 3] = s1, c1, -3.0 * e * (s1 * j + s / rho**2)
    return out


def _inverse(nu: Floats, e: float) -> Floats:
    """The inverse of :func:`_fundamental` at J = 0."""
    sin, cos = np.sin(nu), np.cos(nu)
    rho = 1.0 + e * cos
    s, c, more = rho * sin, rho * cos, 1.0 + 1.0 / rho
    out = np.zeros((len(nu), 4, 4))
    out[:, 0, 0] = 1.0 - e * e
    out[:, 0, 1], out[:, 0, 2], out[:, 0, 3] = 3.0 * e * (s / rho) * more, -e * s * more, 2.0 - e * c
    out[:, 1, 1], out[:, 1, 2] = -3.0 * (s / rho) * (1.0 + e * e / rho), s * more
    out[:, 1, 3] = c - 2.0 * e
    out[:, 2, 1], out[:, 2, 2], out[:, 2, 3] = -3.0 * (c / rho + e), c * more + e, -s
    out[:, 3, 1], out[:, 3, 2], out[:, 3, 3] = 3.0 * rho + e * e - 1.0, -rho * rho, e * s
    return out / (1.0 - e * e)


def _out_of_plane(nu: Floats) -> Floats:
    """(J, 2, 2): turned by nu."""
    sin, cos = np.sin(nu), np.cos(nu)
    return np.stack([np.stack([cos, sin], axis=-1), np.stack([-sin, cos], axis=-1)], axis=-2)


def _dimensional(plane: Floats, across: Floats, first: Floats, last: Floats, e: float, pace: float) -> Floats:
    """Phi (J, 6, 6) in metres and seconds, our LVLH axes."""
    rho0, rho1 = 1.0 + e * np.cos(first), 1.0 + e * np.cos(last)
    slope0, slope1 = e * np.sin(first), e * np.sin(last)
    count = len(first)
    scaled = np.zeros((count, 6, 6))
    # Ours are (x, y, z) = (-nadir, along, z): the sign cancels where both ends have it.
    order = ((0, 1, -1.0), (1, 0, 1.0))
    for i, a, sa in order:
        for j, b, sb in order:
            for low, high in ((0, 0), (0, 1), (1, 0), (1, 1)):
                scaled[:, i + 3 * low, j + 3 * high] = sa * sb * plane[:, a + 2 * low, b + 2 * high]
    for low, high in ((0, 0), (0, 1), (1, 0), (1, 1)):
        scaled[:, 2 + 3 * low, 2 + 3 * high] = across[:, low, high]
    # q = rho r and q' = -e sin r + v / (pace rho) at the start; r = q / rho and v = pace (e sin q + rho q') at the end.
    begin, end = np.zeros((count, 6, 6)), np.zeros((count, 6, 6))
    for i in range(3):
        begin[:, i, i], begin[:, i + 3, i], begin[:, i + 3, i + 3] = rho0, -slope0, 1.0 / (pace * rho0)
        end[:, i, i], end[:, i + 3, i], end[:, i + 3, i + 3] = 1.0 / rho1, pace * slope1, pace * rho1
    out: Floats = end @ scaled @ begin
    return out
