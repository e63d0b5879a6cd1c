"""Kalman filter and tightened rows: plans from estimates that stay within the corridor with errors.

The estimate moves by the regulated deviation's motion F = A + B K, plus L nu with nu the innovation: the plan of the
next step may follow the old one with w_i + K F^i L nu. So what later innovations can add at step i is the sum of
F^l L nu over l < i, in LVLH: constant, whatever the attitude. A row loses 3 sigma of it (root of squares, in the worst
direction), or the sum of the steps' 3 sigma for ``bounded`` errors; rows on the position lose that of the filter's
error as well. The regulator stands for the last two inputs, too: dead-beat is part of the plan, not of its changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_discrete_are

from safestart.control.tracking_mpc.condensed import condense
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.tuning import Tuning
from safestart.errors import invalid
from safestart.model.scenario import Floats

SIGMAS = 3.0
_LEAST, _SHARE = 1e-6, 1e-3
"""Least deviations, m and m/s, and least share of one kind's deviation in another's. Without them the steady filter of
exact measurements or exact inputs has no solution in double precision; larger errors only tighten more."""


@dataclass(frozen=True, slots=True)
class Errors:
    """Standard deviations per axis: ``position`` m and ``velocity`` m/s of navigation, ``impulse`` m/s of an input."""

    position: float
    velocity: float
    impulse: float


@dataclass(frozen=True)
class Tube:
    """``gain`` (6, 6) of the steady filter; what rows lose: ``corridor`` (N_p + 1,) m, ``inputs`` (N_p,) m/s."""

    gain: Floats
    corridor: Floats
    inputs: Floats


def tube_of(motion: Sampled, tuning: Tuning, errors: Errors, *, bounded: bool = False) -> Tube:
    """The filter and the tightening; raises ``InvalidInput`` for errors that leave no input."""
    place, speed = max(errors.position, _LEAST), max(errors.velocity, _LEAST)
    place, speed = max(place, _SHARE * speed * motion.period), max(speed, _SHARE * place / motion.period)
    measured = np.diag([place**2] * 3 + [speed**2] * 3)
    pushed = max(errors.impulse, _SHARE * speed) ** 2 * (motion.b @ motion.b.T)
    predicted = solve_discrete_are(motion.a.T, np.eye(6), pushed, measured)
    innovation = predicted + measured
    gain = predicted @ np.linalg.inv(innovation)
    filtered = predicted - gain @ predicted
    step = gain @ innovation @ gain.T
    shared = condense(motion, tuning.n_c, tuning.n_lqr, tuning.rho)
    power, spread = np.eye(6), np.zeros((6, 6))
    places, pushes = [_largest(filtered[:3, :3])], [0.0]
    place_sum, push_sum = 0.0, 0.0
    for _ in range(tuning.inputs):
        one = power @ step @ power.T
        spread = spread + one
        place_sum += _largest(one[:3, :3])
        push_sum += _largest(shared.gain @ one @ shared.gain.T)
        own = _largest(filtered[:3, :3])
        if bounded:
            places.append(own + place_sum)
            pushes.append(push_sum)
        else:
            places.append(_largest(filtered[:3, :3] + spread[:3, :3]))
            pushes.append(_largest(shared.gain @ spread @ shared.gain.T))
        power = shared.closed @ power
    corridor, inputs = SIGMAS * np.array(places), SIGMAS * np.array(pushes[:-1])
    if inputs.max() >= tuning.u_max:
        required = f"errors whose tube needs less than u_max, {tuning.u_max:g} m/s"
        raise invalid("study", required, f"{inputs.max():.3g} m/s")
    return Tube(np.asarray(gain, dtype=np.float64), corridor, inputs)


def _largest(covariance: Floats) -> float:
    return math.sqrt(max(float(np.linalg.eigvalsh(0.5 * (covariance + covariance.T))[-1]), 0.0))
