"""Where the branch of hops ends: the angle at which its root of the hop-time equation meets another one.

Both vanish beyond the fold. For rho up to ``CUSP`` there is no fold: the branch reaches the V-bar behind the target. In
q = (1 - rho)^(1/4) the fold's phase and its distance from 180 deg are smooth down to q = 0, where both vanish like q; a
table over q starts Newton's method in g = 0, dg/dphi = 0.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from safestart.hopping.hop_equation import residual, weights
from safestart.model.scenario import Floats

CUSP = 0.232648
"""g, dg/dphi and d^2g/dphi^2 vanish together at rho = 0.23264785, theta = 154.756 deg, 0.6065 orbits: no fold below."""

_NODES = 240


def fold_of(rho: Floats) -> tuple[Floats, Floats]:
    """Phase (rad) and angle (rad) of the fold of each of ``rho`` (K,) in (0, 1); 2 pi and pi where there is none."""
    phase, angle = np.full(rho.shape, math.tau), np.full(rho.shape, math.pi)
    folded = rho > CUSP
    if folded.any():
        left = rho[folded]
        nodes, phases, angles = _table()
        q = (1.0 - left) ** 0.25
        start = np.interp(q, nodes, phases), np.interp(q, nodes, angles)
        phase[folded], angle[folded] = _newton(*start, left, 3)
    return phase, angle


@cache
def _table() -> tuple[Floats, Floats, Floats]:
    """Fold over q: nodes, phases, angles; followed from q = 0.1778, where the small-hop law holds to a few percent."""
    begin = (1.0 - 0.999) ** 0.25
    end = (1.0 - CUSP) ** 0.25
    # The phase behaves like a square root at the cusp, so nodes are dense there.
    nodes = end - (end - begin) * np.linspace(1.0, 1e-2, _NODES) ** 2
    phase, angle = np.array([0.3005]), np.array([math.radians(171.458)])
    phases, angles = np.empty(_NODES), np.empty(_NODES)
    for k, q in enumerate(nodes):
        phase, angle = _newton(phase, angle, np.array([1.0 - q**4]), 8)
        phases[k], angles[k] = phase[0], angle[0]
    # Below the first node both are close to proportional to q.
    return np.r_[0.0, nodes], np.r_[0.0, phases], np.r_[math.pi, angles]


def _newton(phase: Floats, angle: Floats, rho: Floats, steps: int) -> tuple[Floats, Floats]:
    """Newton's method in (g, dg/dphi) = 0 over (phi, theta)."""
    for _ in range(steps):
        value, slope, by_angle, slope_by_angle, bend = _jet(phase, angle, rho)
        determinant = slope * slope_by_angle - by_angle * bend
        phase = phase - (slope_by_angle * value - by_angle * slope) / determinant
        angle = angle - (slope * slope - bend * value) / determinant
    return phase, angle


def _jet(phi: Floats, theta: Floats, rho: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """g, g_phi, g_theta, g_phi_theta, g_phi_phi."""
    secular, weight, turning, _ = terms = weights(theta, rho)
    value, slope = residual(phi, terms)
    sine, cosine = np.sin(phi), np.cos(phi)
    # g is linear in S and sin 2 theta; dS/dtheta = sin 2 theta.
    double, across = np.sin(2.0 * theta), 2.0 * np.cos(2.0 * theta)
    by_square = 3.0 * (phi * (1.0 - rho * cosine) - (1.0 - rho) * sine)
    by_double = -3.0 * rho * (phi * sine - 2.0 + 2.0 * cosine)
    slope_by_square = 3.0 * (1.0 - cosine + rho * phi * sine)
    slope_by_double = -3.0 * rho * (phi * cosine - sine)
    bend = secular * rho * (2.0 * sine + phi * cosine) + weight * sine + turning * phi * sine
    by_angle = by_square * double + across * by_double
    slope_by_angle = slope_by_square * double + across * slope_by_double
    return value, slope, by_angle, slope_by_angle, bend
