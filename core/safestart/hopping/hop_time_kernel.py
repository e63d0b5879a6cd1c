"""Hop times by compiled code: the same equation and branch as ``hop_time``, for many pairs and for controllers.

The service answers with the NumPy form, which loads no compiler; both agree to rounding.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.hopping.fold import fold_of
from safestart.hopping.hop_time import NEAR, PHASES, SAMPLED, checked
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

_STEPS, _HALVINGS = 8, 60
_SETTLED = 1e-9
"""A step below this share of the phase: the next one would be below rounding."""


def compiled_hop_phases(angle_deg: Floats, rho: Floats) -> Floats:
    """As :func:`safestart.hopping.hop_time.hop_phases`."""
    turned, left = checked(angle_deg, rho)
    tops, ends = np.full(left.shape, np.inf), np.full(left.shape, math.pi)
    near = np.flatnonzero(turned > NEAR)
    if len(near):
        tops[near], ends[near] = fold_of(left[near])
    phases = np.empty(left.shape)
    _phases(turned, left, tops, ends, PHASES, SAMPLED, phases)
    return phases


@compiled(error_model="numpy")
def _phases(
    turned: Floats, rho: Floats, tops: Floats, ends: Floats, nodes: Floats, sampled: Floats, out: Floats
) -> None:
    for i in range(len(turned)):
        theta = math.radians(turned[i])
        if turned[i] == 0.0:
            out[i] = math.pi
        elif theta > ends[i]:
            out[i] = math.nan
        else:
            out[i] = _first_root(theta, rho[i], tops[i], nodes, sampled)


@compiled(error_model="numpy")
def _first_root(theta: float, rho: float, top: float, nodes: Floats, sampled: Floats) -> float:
    """First positive root of g up to ``top``: sampled signs, a chord, Newton's method within the bracket."""
    sine = math.sin(theta)
    square, double = sine * sine, math.sin(2.0 * theta)
    secular = 3.0 * square
    weight, turning = (1.0 + secular) * (1.0 - rho), 3.0 * rho * double
    both, mixed = rho * square, rho * double
    low, below = 0.0, 0.0
    high, above = nodes[len(nodes) - 1], 0.0
    for k in range(len(nodes)):
        value = (
            sampled[0, k]
            + square * sampled[1, k]
            + rho * sampled[2, k]
            + both * sampled[3, k]
            + mixed * sampled[4, k]
        )
        if value >= 0.0 or top <= nodes[k]:
            high, above = nodes[k], value
            break
        low, below = nodes[k], value
    if low > 0.0:
        phi = low - below * (high - low) / (above - below)
    else:
        phi = min(math.sqrt((1.0 - rho) / (1.5 * square)), 0.5 * high)
    high = min(high, top)
    start = phi
    for _ in range(_STEPS):
        value, slope = _residual(phi, secular, weight, turning, rho)
        step = value / slope
        phi -= step
        if abs(step) < _SETTLED * phi:
            break
    if low <= phi <= high and abs(step) < _SETTLED * phi:
        return float(phi)
    return float(_bracketed(low, high, min(max(start, low), high), secular, weight, turning, rho))


@compiled(error_model="numpy")
def _residual(phi: float, secular: float, weight: float, turning: float, rho: float) -> tuple[float, float]:
    """g and dg/dphi (``hop_equation.residual``)."""
    sine, cosine = math.sin(phi), math.cos(phi)
    left, lever = 1.0 - rho * cosine, phi * sine
    value = secular * phi * left - weight * sine - turning * (lever - 2.0 + 2.0 * cosine)
    slope = secular * (left + rho * lever) - weight * cosine - turning * (phi * cosine - sine)
    return value, slope


@compiled(error_model="numpy")
def _bracketed(
    low: float, high: float, phi: float, secular: float, weight: float, turning: float, rho: float
) -> float:
    """Newton's method; a step that would leave the bracket halves it."""
    for _ in range(_HALVINGS):
        value, slope = _residual(phi, secular, weight, turning, rho)
        if value < 0.0:
            low = phi
        else:
            high = phi
        moved = phi - value / slope
        if not low <= moved <= high:
            moved = 0.5 * (low + high)
        # Near a fold g is flat, and its rounding ends the search.
        settled = abs(moved - phi) <= 1e-14 * phi or abs(value) <= 2e-16 * phi
        phi = moved
        if settled:
            break
    return phi
