"""Nonlinear relative motion as the linear one plus a bounded disturbance, with radii found and proved automatically.

With a = -mu q/|q|^3, |D^2 a [v, v]| <= 6 mu |v|^2/|q|^4; so the linearisation at the target leaves out

    |w| <= 3 mu rho^2/(r - rho)^4     (Lagrange's remainder, rho the distance from the target, r the orbit radius),

and the state is e^{At} z_0 + e(t), |e(t)| <= int_0^t |e^{As} B| ds . sup |w|. The radius in sup |w| includes e itself.
A trial radius is accepted when the motion that it permits stays strictly inside it; by continuity the true motion then
does too.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import numpy as np

from safestart.model.scenario import Floats
from safestart.passive_safety.model import MU, RADIUS, Dynamics, Motion
from safestart.passive_safety.reach.flow import flow_table, growth
from safestart.passive_safety.reach.rounding import UP

UNBOUNDED = 1e30
"""Stands for an unbounded deviation (m, m/min), with which no requirement can be proved."""

_SUM_UP = 1.0 + 2.0**-38
"""Covers the roundings of a running sum of up to 16 000 terms."""

_BEFORE = 64
_TRIALS = 12


def gravity_remainder(radius: Floats) -> Floats:
    """Bound (...,) on |w|, m/min^2, at distances up to ``radius`` (...,) m from the target; infinite from r/2 on."""
    near = np.minimum(radius, 0.5 * RADIUS)
    bound = UP * 3.0 * MU * near**2 / (RADIUS - near) ** 4
    result: Floats = np.where(radius < 0.5 * RADIUS, bound, np.inf)
    return result


@cache
def influence(motion: Motion, start: Fraction, step: Fraction, steps: int) -> Floats:
    """Bounds (n+1, 4) on int_0^t |e^{As} B| ds (1, 1)' at t_k = start + k step: deviation per unit of |w|."""
    phi = np.abs(flow_table(motion, start, step, steps).phi[:-1, :, 2:]).sum(axis=2)
    before = np.zeros(4)
    if start > 0:
        before = influence(motion, Fraction(0), start / _BEFORE, _BEFORE)[-1]
    each = float(step) * (phi @ growth(motion, step).T)
    result: Floats = _SUM_UP * np.concatenate([before[None], before + np.cumsum(each, axis=0)])
    return result


def deviation(per_unit: Floats, radius: Floats) -> Floats:
    """Bounds (..., n, 4) on the deviation from the linear motion up to each of n times.

    ``per_unit`` (n, 4): see :func:`influence`. ``radius`` (..., n): distances from the target (m) that the linear
    motion does not exceed up to each time.
    """
    radius = np.maximum.accumulate(radius, axis=-1)
    trial = 1.001 * radius + 1e-6
    found = np.zeros(radius.shape, dtype=np.bool_)
    strays = np.zeros((*radius.shape, 4))
    for _ in range(_TRIALS):
        strays = per_unit * gravity_remainder(trial)[..., None]
        needed = UP * (radius + np.hypot(strays[..., 0], strays[..., 1]))
        # A radius is accepted only with all earlier ones, which the sup of |w| up to a time needs.
        found = np.logical_and.accumulate(needed < trial, axis=-1)
        if found.all():
            break
        trial = np.maximum.accumulate(np.where(found, trial, 1.05 * needed), axis=-1)
    result: Floats = np.where(found[..., None], UP * strays, UNBOUNDED)
    return result


def is_nonlinear(motion: Motion) -> bool:
    """Whether the motion has a remainder at all."""
    return motion.dynamics is Dynamics.NONLINEAR
