"""Simulated flights of either dynamics by a Runge-Kutta method of order 8: the independent check of nonlinear
proofs."""

from __future__ import annotations

import numpy as np
from scipy.integrate import DOP853

from safestart.model.scenario import Floats
from safestart.passive_safety.flights.flight_kernel import fly
from safestart.passive_safety.model import (
    MASS,
    MU,
    RADIUS,
    Dynamics,
    Mode,
    System,
    coefficients,
    gain,
    matrix,
)
from safestart.passive_safety.switching_guard import FACE_LIMITS, FACES, GAP_GUARD, Guard

_FAST, _FAST_LENGTH, _SLOW, _LONGEST = 0.12, 30.0, 1.5, 0.25
_DRIFT_STEP = 0.5


def simulate(system: System, starts: Floats, aborts: Floats, times: Floats) -> tuple[Floats, Floats]:
    """States (N, T, 4) at ``times`` (N, T) of ``starts`` (N, 4) whose engines fail at ``aborts`` (N,), min; inf: never.

    Second result: first entries (N,) into the guard, inf without an entry.
    """
    order = np.argsort(times, axis=1)
    motions = [system.motion(mode) for mode in (Mode.FAR, Mode.NEAR, Mode.PASSIVE)]
    three_n2, two_n = (float(v) for v in coefficients(system.dynamics))
    mu = MU if system.dynamics is Dynamics.NONLINEAR else 0.0
    states, entries = fly(
        np.ascontiguousarray(starts),
        aborts.astype(np.float64),
        np.take_along_axis(times, order, axis=1),
        np.stack([gain(motion) for motion in motions]) / MASS,
        np.array([three_n2, two_n, mu, RADIUS]),
        FACES,
        FACE_LIMITS,
        GAP_GUARD if system.guard is Guard.CIRCLE else 0.0,
        _pace(system),
        np.ascontiguousarray(DOP853.A),
        np.ascontiguousarray(DOP853.B),
    )
    back = np.empty_like(states)
    np.put_along_axis(back, order[..., None], states, axis=1)
    return back, entries


def _pace(system: System) -> Floats:
    """Steps (3, 3) per mode: fine while the fastest motion lasts, then as long as stability allows."""
    pace = np.full((3, 3), _DRIFT_STEP)
    for row, mode in zip(pace, (Mode.FAR, Mode.NEAR), strict=False):
        rate = float(np.abs(np.linalg.eigvals(matrix(system.motion(mode)))).max())
        row[:] = _FAST / rate, _FAST_LENGTH / rate, min(_SLOW / rate, _LONGEST)
    return pace
