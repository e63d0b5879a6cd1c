"""Exact flights of single starts in the linear motion: the independent check of every proof and search.

Modes 1 and 2 use their eigenvectors, the drift its closed form, the crossing bisection. They use no sets and no tables
of :mod:`safestart.passive_safety.reach.flow`. They would miss a first entry shorter than the scan step (0.1 min), so
these are simulations, not proofs. For a nonlinear system they fly the linearisation.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from safestart.model.scenario import Bools, Floats
from safestart.passive_safety.model import Dynamics, Mode, Motion, System, coefficients, matrix
from safestart.passive_safety.switching_guard import depth, gradient

_SCAN = 0.1
_BISECTIONS, _NEWTONS = 8, 4


@cache
def _modes(motion: Motion) -> tuple[NDArray[np.complex128], NDArray[np.complex128], NDArray[np.complex128]]:
    values, vectors = np.linalg.eig(matrix(motion).astype(np.complex128))
    return values, vectors, np.linalg.inv(vectors)


def flown(motion: Motion, start: Floats, times: Floats) -> Floats:
    """States (..., 4) of ``start`` (..., 4) after ``times`` (...), which broadcast; modes 1 and 2 only."""
    values, vectors, inverse = _modes(motion)
    parts = np.exp(values * times[..., None]) * (start @ inverse.T)
    result: Floats = (parts @ vectors.T).real
    return result


def drifted(dynamics: Dynamics, start: Floats, times: Floats) -> Floats:
    """Positions (..., 2) of the passive motion of ``start`` (..., 4) after ``times`` (...) minutes; closed form."""
    n = float(coefficients(dynamics)[1]) / 2.0
    p = n * times
    sine, versine = np.sin(p), 2.0 * np.sin(0.5 * p) ** 2
    x, y, vx, vy = (start[..., k] for k in range(4))
    radial = (1.0 + 3.0 * versine) * x + sine / n * vx + 2.0 * versine / n * vy
    along = 6.0 * (sine - p) * x + y - 2.0 * versine / n * vx + (4.0 * sine - 3.0 * p) / n * vy
    return np.stack([radial, along], axis=-1)


def crossing_times(
    system: System, starts: Floats, horizon: float, bracket: tuple[float, float] | None = None
) -> Floats:
    """First entry (N,) of ``starts`` (N, 4) into the guard, min; inf without one up to ``horizon``.

    ``bracket``: times between which every start is known to enter once; replaces the scan.
    """
    far = system.motion(Mode.FAR)
    if bracket is None:
        low, found = _scan(system, starts, horizon)
        high = low + _SCAN
    else:
        low, high = (np.full(len(starts), t) for t in bracket)
        found = np.ones(len(starts), dtype=np.bool_)
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        inside = depth(system.guard, flown(far, starts, middle)[:, :2]) < 0.0
        high, low = np.where(inside, middle, high), np.where(inside, low, middle)
    at = 0.5 * (low + high)
    for _ in range(_NEWTONS):
        states = flown(far, starts, at)
        rate = np.einsum("nj,nj->n", gradient(system.guard, states[:, :2]), states[:, 2:])
        # At a tangential entry Newton's method fails, so keep the bisection.
        height = depth(system.guard, states[:, :2])
        step = np.where(rate < 0.0, -height / np.where(rate < 0.0, rate, 1.0), 0.0)
        at = np.clip(at + step, low, high)
    return np.where(found, at, np.inf)


def _scan(system: System, starts: Floats, horizon: float) -> tuple[Floats, Bools]:
    """Last scan time outside (N,), and whether the next one is inside (N,)."""
    low = np.zeros(len(starts))
    waiting, states = np.arange(len(starts)), starts
    found: Bools = np.zeros(len(starts), dtype=np.bool_)
    one = flown(system.motion(Mode.FAR), np.eye(4), np.full(4, _SCAN))
    for k in range(1, int(np.ceil(horizon / _SCAN)) + 1):
        states = states @ one
        inside = depth(system.guard, states[:, :2]) < 0.0
        if inside.any():
            found[waiting[inside]] = True
            low[waiting[inside]] = (k - 1) * _SCAN
            waiting, states = waiting[~inside], states[~inside]
            if not len(waiting):
                break
    return low, found


def active(system: System, starts: Floats, crossings: Floats, times: Floats) -> Floats:
    """States (..., 4) at ``times`` (...) with the engines on, given the crossing times; all broadcast together."""
    until = np.minimum(times, crossings)
    states = flown(system.motion(Mode.FAR), starts, until)
    since = np.where(np.isfinite(crossings), np.maximum(times - until, 0.0), 0.0)
    after = flown(system.motion(Mode.NEAR), states, since)
    return np.where((since > 0.0)[..., None], after, states)
