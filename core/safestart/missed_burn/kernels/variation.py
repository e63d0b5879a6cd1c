"""The course of a target about the Earth with J2, and the linear motion of a chaser near it, compiled.

Inertial axes, m and m/s. The transition Phi of relative states has Phi' = [[0, I], [G, 0]] Phi, with G the gradient of
gravity along the course. Both are integrated by the Runge-Kutta method of order 8 of DOP853 with steps of one length.
"""

from __future__ import annotations

import numpy as np

from safestart.dynamics.two_body import J2
from safestart.model.orbit import EARTH_RADIUS as RADIUS
from safestart.model.orbit import MU
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

BULGE = MU * J2 * RADIUS * RADIUS


@compiled()
def gradient(position: Floats, pull: Floats, slope: Floats) -> None:
    """Gravity (3,) and its gradient (3, 3) at an inertial position (3,)."""
    z = position[2]
    s = position[0] ** 2 + position[1] ** 2 + z * z
    a3 = 1.0 / (s * np.sqrt(s))
    a5, a7 = a3 / s, a3 / (s * s)
    a9 = a7 / s
    level = -MU * a3 - 1.5 * BULGE * (a5 - 5.0 * z * z * a7)
    alpha = 3.0 * MU * a5 + 7.5 * BULGE * a7 - 52.5 * BULGE * z * z * a9
    beta, gamma = 15.0 * BULGE * z * a7, -3.0 * BULGE * a5
    for i in range(3):
        pull[i] = level * position[i]
        for j in range(3):
            slope[i, j] = alpha * position[i] * position[j]
        slope[i, i] += level
    pull[2] += gamma * z
    for i in range(3):
        slope[i, 2] += beta * position[i]
        slope[2, i] += beta * position[i]
    slope[2, 2] += gamma


@compiled()
def _rates(y: Floats, out: Floats, pull: Floats, slope: Floats) -> None:
    """``y`` and ``out`` (42,): position and velocity, then the columns of Phi, positions and velocities."""
    gradient(y[:3], pull, slope)
    for i in range(3):
        out[i], out[3 + i] = y[3 + i], pull[i]
    for j in range(6):
        at, fast = 6 + 3 * j, 24 + 3 * j
        for i in range(3):
            out[at + i] = y[fast + i]
            out[fast + i] = slope[i, 0] * y[at] + slope[i, 1] * y[at + 1] + slope[i, 2] * y[at + 2]


@compiled()
def _stepped(
    y: Floats,
    step: float,
    stages: Floats,
    weights: Floats,
    stage: Floats,
    rates: Floats,
    pull: Floats,
    slope: Floats,
) -> None:
    """One step of ``y`` (42,), in place."""
    for s in range(12):
        for i in range(42):
            stage[i] = y[i]
        for j in range(s):
            a = step * stages[s, j]
            if a != 0.0:
                for i in range(42):
                    stage[i] += a * rates[j, i]
        _rates(stage, rates[s], pull, slope)
    for j in range(12):
        a = step * weights[j]
        for i in range(42):
            y[i] += a * rates[j, i]


@compiled()
def course_of(start: Floats, step: float, count: int, every: int, stages: Floats, weights: Floats) -> Floats:
    """The states alone (M, 6) of :func:`carried`, to the last bit."""
    course = np.empty((count // every + 1, 6))
    y, stage, rates = start.copy(), np.empty(6), np.empty((12, 6))
    pull, slope = np.empty(3), np.empty((3, 3))
    for k in range(count + 1):
        if k % every == 0:
            for i in range(6):
                course[k // every, i] = y[i]
        if k == count:
            break
        for s in range(12):
            for i in range(6):
                stage[i] = y[i]
            for j in range(s):
                a = stages[s, j]
                if a != 0.0:
                    for i in range(6):
                        stage[i] += step * a * rates[j, i]
            gradient(stage[:3], pull, slope)
            for i in range(3):
                rates[s, i], rates[s, 3 + i] = stage[3 + i], pull[i]
        for j in range(12):
            for i in range(6):
                y[i] += step * weights[j] * rates[j, i]
    return course


@compiled()
def carried(
    target: Floats, step: float, count: int, every: int, stages: Floats, weights: Floats
) -> tuple[Floats, Floats]:
    """``count`` steps from a target's state (6,): states (M, 6) and transitions (M, 6, 6) at the start and after
    every ``every`` steps."""
    size = count // every + 1
    course, tables = np.empty((size, 6)), np.empty((size, 6, 6))
    y, stage, rates = np.zeros(42), np.empty(42), np.empty((12, 42))
    pull, slope = np.empty(3), np.empty((3, 3))
    for i in range(6):
        y[i] = target[i]
    for i in range(3):
        y[6 + 4 * i] = y[33 + 4 * i] = 1.0
    for k in range(count + 1):
        if k % every == 0:
            at = k // every
            for i in range(6):
                course[at, i] = y[i]
                for j in range(3):
                    tables[at, j, i], tables[at, 3 + j, i] = y[6 + 3 * i + j], y[24 + 3 * i + j]
        if k < count:
            _stepped(y, step, stages, weights, stage, rates, pull, slope)
    return course, tables
