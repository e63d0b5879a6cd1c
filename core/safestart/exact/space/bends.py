"""A bound on the fourth derivative of a face's distance, from samples of a flight.

In LVLH r'' = A(t) r + 2 w J v + u with A of the tide g and the turn w = nu' of LVLH, |J| = 1. Differentiated twice,
with sizes A, A1, A2 of A and its derivatives and w, w1, w2 of w,

    |r'''| <= A v + A1 r + 2 (w a + w1 v)
    |r''''| <= A a + 2 A1 v + A2 r + 2 (w j + 2 w1 a + w2 v),

and Leibniz joins them with the derivatives of the normal.
"""

from __future__ import annotations

import math

from safestart.attitude.turning import Bounds
from safestart.model.orbit import KeplerOrbit


def bend_of(
    orbit: KeplerOrbit, turning: Bounds, half: float, furthest: float, fastest: float, push: float
) -> float:
    """Bound, m/s^4, on the fourth derivative of every distance; inf if none is found.

    ``furthest`` (m) and ``fastest`` (m/s) hold at samples; every time is within ``half`` s of one. ``push`` m/s^2
    bounds the thrust, ``turning`` the derivatives of the normals.
    """
    w, w1, w2, w3 = orbit.turn_bounds()
    g, g1, g2 = orbit.tide_bounds()
    # A = [[w^2 + 2 g, w', 0], [-w', w^2 - g, 0], [0, 0, -g]] and its derivatives.
    a0 = w * w + 2.0 * g + w1
    a1 = 2.0 * w * w1 + 2.0 * g1 + w2
    a2 = 2.0 * (w1 * w1 + w * w2) + 2.0 * g2 + w3
    gain = half * (2.0 * w + a0 * half)
    if gain >= 1.0:
        return math.inf
    v = (fastest + half * (a0 * furthest + push)) / (1.0 - gain)
    r = furthest + half * v
    a = a0 * r + 2.0 * w * v + push
    jerk = a0 * v + a1 * r + 2.0 * (w * a + w1 * v)
    snap = a0 * a + 2.0 * a1 * v + a2 * r + 2.0 * (w * jerk + 2.0 * w1 * a + w2 * v)
    d1, d2, d3, d4 = turning
    return d4 * r + 4.0 * d3 * v + 6.0 * d2 * a + 4.0 * d1 * jerk + snap
