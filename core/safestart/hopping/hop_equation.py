"""The hop-time equation in closed form: one hop along a line through the target, in CWH motion.

A hop starts at distance d on a line that makes the angle theta with the V-bar (90 deg: below the target), ends at
rho d on the same line, and ends with its velocity perpendicular to the line (paper 004, eqs. 23-25, with the printed
phi_pp^11 on the right of eq. 24 corrected to phi_vp^11). With S = sin^2 theta and phi = n t,

    rho = N / D,  N = 3 phi S - (1 + 3 S) sin phi,
                  D = 3 phi S cos phi - (1 + 3 S) sin phi + 3 sin 2 theta (phi sin phi - 2 (1 - cos phi)).

The hop is a root of g = N - rho D. g is smooth where rho itself has poles, and g = 0 holds on the V-bar (S = 0) at
phi = pi for every rho, so no case is singular.
"""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats


def weights(theta: Floats, rho: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Terms of :func:`residual` from angles (rad) and shares: 3 S, (1 + 3 S)(1 - rho), 3 rho sin 2 theta, rho."""
    sine = np.sin(theta)
    secular = 3.0 * sine * sine
    return secular, (1.0 + secular) * (1.0 - rho), 3.0 * rho * np.sin(2.0 * theta), rho


def residual(phi: Floats, terms: tuple[Floats, Floats, Floats, Floats]) -> tuple[Floats, Floats]:
    """g and dg/dphi at the phases ``phi`` (rad); everything broadcasts."""
    secular, weight, turning, rho = terms
    sine, cosine = np.sin(phi), np.cos(phi)
    left, lever = 1.0 - rho * cosine, phi * sine
    value = secular * phi * left - weight * sine - turning * (lever - 2.0 + 2.0 * cosine)
    slope = secular * (left + rho * lever) - weight * cosine - turning * (phi * cosine - sine)
    return value, slope
