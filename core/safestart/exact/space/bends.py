"""Bounds on fourth derivatives of distances and of the square of the speed, from samples of a flight.

In LVLH r'' = A(t) r + 2 w J v + u with A of the tide g and the turn w = nu' of LVLH, |J| = 1. Differentiated with sizes
A, A1, A2, A3 of A and its derivatives and w, w1, w2, w3 of w,

    |r'''| <= A v + A1 r + 2 (w a + w1 v)
    |r''''| <= A a + 2 A1 v + A2 r + 2 (w j + 2 w1 a + w2 v)
    |r'''''| <= A j + 3 A1 a + 3 A2 v + A3 r + 2 (w s + 3 w1 j + 3 w2 a + w3 v),

and Leibniz joins them with the derivatives of the normal, or of v . v.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from safestart.attitude.turning import Bounds
from safestart.model.orbit import KeplerOrbit


class Rates(NamedTuple):
    """Bounds on |r| and its first five derivatives in LVLH, m/s^k; inf if none is found."""

    r: float
    v: float
    a: float
    jerk: float
    snap: float
    crackle: float


def rates_of(orbit: KeplerOrbit, half: float, furthest: float, fastest: float, push: float) -> Rates:
    """``furthest`` (m) and ``fastest`` (m/s) hold at samples; every time is within ``half`` s of one.

    ``push`` m/s^2 bounds the thrust.
    """
    w, w1, w2, w3 = orbit.turn_bounds()
    g, g1, g2 = orbit.tide_bounds()
    w4, g3 = orbit.further_bounds()
    # A = [[w^2 + 2 g, w', 0], [-w', w^2 - g, 0], [0, 0, -g]] and its derivatives.
    a0 = w * w + 2.0 * g + w1
    a1 = 2.0 * w * w1 + 2.0 * g1 + w2
    a2 = 2.0 * (w1 * w1 + w * w2) + 2.0 * g2 + w3
    a3 = 2.0 * (3.0 * w1 * w2 + w * w3) + 2.0 * g3 + w4
    gain = half * (2.0 * w + a0 * half)
    if gain >= 1.0:
        return Rates(*(math.inf,) * 6)
    v = (fastest + half * (a0 * furthest + push)) / (1.0 - gain)
    r = furthest + half * v
    a = a0 * r + 2.0 * w * v + push
    jerk = a0 * v + a1 * r + 2.0 * (w * a + w1 * v)
    snap = a0 * a + 2.0 * a1 * v + a2 * r + 2.0 * (w * jerk + 2.0 * w1 * a + w2 * v)
    crackle = a0 * jerk + 3.0 * a1 * a + 3.0 * a2 * v + a3 * r
    crackle += 2.0 * (w * snap + 3.0 * w1 * jerk + 3.0 * w2 * a + w3 * v)
    return Rates(r, v, a, jerk, snap, crackle)


def of_distance(rates: Rates, turning: Bounds) -> float:
    """Bound, m/s^4, for every distance; ``turning`` bounds the derivatives of the normals."""
    d1, d2, d3, d4 = turning
    return d4 * rates.r + 4.0 * d3 * rates.v + 6.0 * d2 * rates.a + 4.0 * d1 * rates.jerk + rates.snap


def of_speed(rates: Rates) -> float:
    """Bound, m^2/s^6, for |v|^2."""
    return 2.0 * (rates.v * rates.crackle + 4.0 * rates.a * rates.snap + 3.0 * rates.jerk * rates.jerk)
