"""Replay one flight by another library: matrix exponentials, or an adaptive integrator of order 8 (nonlinear)."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from safestart.model.scenario import Bools, Floats
from safestart.passive_safety.model import MASS, MU, RADIUS, Dynamics, Mode, System, gain, matrix
from safestart.passive_safety.switching_guard import depth, gradient

_REPLAY_STEP, _NEWTONS = 0.05, 6
_RELATIVE, _ABSOLUTE = 1e-12, 1e-10


def replay(system: System, start: Floats, abort: float, time: float) -> Floats:
    """State (4,) at ``time`` of the flight from ``start`` (4,) whose engines fail at ``abort`` (min); inf: never."""
    fly = _nonlinear if system.dynamics is Dynamics.NONLINEAR else _linear
    return fly(system, np.asarray(start, dtype=np.float64), abort, time)


def kepler(state: Floats, force: Floats) -> Floats:
    """Rates (4,) of eq. 1 in Hill's frame under ``force`` (2,), kg m/min^2."""
    x, y, vx, vy = state
    rate = np.sqrt(MU / RADIUS**3)
    pull = MU / ((RADIUS + x) ** 2 + y**2) ** 1.5
    ax = rate**2 * x + 2.0 * rate * vy + MU / RADIUS**2 - pull * (RADIUS + x) + force[0] / MASS
    return np.array([vx, vy, ax, rate**2 * y - 2.0 * rate * vx - pull * y + force[1] / MASS])


def _nonlinear(system: System, start: Floats, abort: float, time: float) -> Floats:
    def fly(mode: Mode, state: Floats, low: float, high: float, stop: bool = False) -> tuple[float, Floats]:
        if high <= low:
            return low, state
        feedback = gain(system.motion(mode))

        def entered(_: float, z: Floats) -> float:
            return float(depth(system.guard, z[:2]))

        entered.terminal, entered.direction = True, -1.0  # type: ignore[attr-defined]
        flight = solve_ivp(
            lambda _, z: kepler(z, -feedback @ z),
            (low, high),
            state,
            method="DOP853",
            rtol=_RELATIVE,
            atol=_ABSOLUTE,
            events=entered if stop else None,
        )
        return float(flight.t[-1]), np.asarray(flight.y[:, -1])

    powered = min(time, abort)
    at, state = fly(Mode.FAR, start, 0.0, powered, stop=True)
    at, state = fly(Mode.NEAR, state, at, powered)
    return fly(Mode.PASSIVE, state, powered, time)[1]


def _linear(system: System, start: Floats, abort: float, time: float) -> Floats:
    """Uses matrix exponentials, and for the crossing a scan of 0.05 min and Newton's method."""
    powered, far = min(time, abort), matrix(system.motion(Mode.FAR))
    states = np.asarray(start, dtype=np.float64)[None, :]
    power = np.asarray(expm(far * _REPLAY_STEP))
    while len(states) * _REPLAY_STEP < powered + _REPLAY_STEP:
        states, power = np.concatenate([states, states @ power.T]), power @ power
    entered: Bools = depth(system.guard, states[:, :2]) < 0.0
    k = int(np.argmax(entered))
    crossing = np.inf
    if entered[k]:
        since = 0.5 * _REPLAY_STEP
        for _ in range(_NEWTONS):
            state = expm(far * since) @ states[k - 1]
            height = float(depth(system.guard, state[:2]))
            rate = float(gradient(system.guard, state[:2]) @ state[2:])
            since = float(np.clip(since - height / rate if rate < 0.0 else since, 0.0, _REPLAY_STEP))
        crossing = (k - 1) * _REPLAY_STEP + since
    state = expm(far * min(powered, crossing)) @ np.asarray(start, dtype=np.float64)
    if crossing < powered:
        state = expm(matrix(system.motion(Mode.NEAR)) * (powered - crossing)) @ state
    return np.asarray(expm(matrix(system.motion(Mode.PASSIVE)) * (time - powered)) @ state)
