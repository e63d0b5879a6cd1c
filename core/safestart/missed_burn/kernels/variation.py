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
from safestart.runtime.kernels import compiled

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
    """``y`` and ``out`` (14, 3): position and velocity, then the columns of Phi, positions and velocities."""
    gradient(y[0], pull, slope)
    out[0], out[1] = y[1], pull
    for j in range(6):
        for i in range(3):
            out[2 + j, i] = y[8 + j, i]
            out[8 + j, i] = slope[i, 0] * y[2 + j, 0] + slope[i, 1] * y[2 + j, 1] + slope[i, 2] * y[2 + j, 2]


@compiled()
def carried(
    target: Floats, step: float, count: int, every: int, stages: Floats, weights: Floats
) -> tuple[Floats, Floats]:
    """``count`` steps from a target's state (6,): states (M, 6) and transitions (M, 6, 6) at the start and after
    every ``every`` steps."""
    size = count // every + 1
    course, tables = np.empty((size, 6)), np.empty((size, 6, 6))
    y, stage, rates = np.zeros((14, 3)), np.empty((14, 3)), np.empty((12, 14, 3))
    pull, slope = np.empty(3), np.empty((3, 3))
    y[0], y[1] = target[:3], target[3:]
    for j in range(3):
        y[2 + j, j] = y[11 + j, j] = 1.0
    for k in range(count + 1):
        if k % every == 0:
            at = k // every
            course[at, :3], course[at, 3:] = y[0], y[1]
            for j in range(6):
                tables[at, :3, j], tables[at, 3:, j] = y[2 + j], y[8 + j]
        if k == count:
            break
        for s in range(12):
            stage[:] = y
            for j in range(s):
                a = stages[s, j]
                if a != 0.0:
                    stage += step * a * rates[j]
            _rates(stage, rates[s], pull, slope)
        for j in range(12):
            y += step * weights[j] * rates[j]
    return course, tables
