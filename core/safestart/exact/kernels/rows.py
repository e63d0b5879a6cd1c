"""Rows of face distances at single times, for the CWH motion and a corridor that turns steadily.

The twin of this kernel, written with arrays, is ``Prediction.position_rows``.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.attitude.turn_kernel import out_of_body
from safestart.dynamics import cwh
from safestart.runtime.kernels.compiled import compiled

_phase_functions = compiled()(cwh.phase_functions)


@compiled()
def _moves(mean_motion: float, tau: float, phi: Any, push: Any) -> None:
    """Position rows of the CWH transition, (d, 2 d), and of the held thrust's effect, (d, d), over ``tau`` s."""
    d = len(push)
    p = mean_motion * tau
    f1, f2, f3 = _phase_functions(p)
    square = tau * tau
    swing, sweep = 2.0 * tau * p * f2, 2.0 * square * p * f3
    phi[0, 0], phi[1, 0], phi[1, 1] = 1.0 + 3.0 * p * p * f2, -6.0 * p * p * p * f3, 1.0
    phi[0, d], phi[0, d + 1] = tau * f1, swing
    phi[1, d], phi[1, d + 1] = -swing, tau * (4.0 * f1 - 3.0)
    push[0, 0], push[0, 1] = square * f2, sweep
    push[1, 0], push[1, 1] = -sweep, square * (4.0 * f2 - 1.5)
    if d == 3:
        phi[2, 2], phi[2, 5] = 1.0 - p * p * f2, tau * f1
        push[2, 2] = square * f2


@compiled()
def face_rows(
    times: Any,
    faces: Any,
    normals: Any,
    phase: float,
    rate: float,
    mean_motion: float,
    dt: float,
    free: Any,
    pushed: Any,
) -> Any:
    """-normal . position at J times as rows over the start, (J, 2 d), and over all thrusts, (J, N d).

    ``times`` (J,) in [0, N dt] s, ``faces`` (J,) of ``normals`` (F, d), unit in the body frame, which has turned by
    ``phase`` + ``rate`` t. ``free`` (N, 2 d, 2 d) as in :class:`~safestart.optim.prediction.Prediction`, ``pushed``
    (M >= N - 1, 2 d, d): the effect of one thrust at the m + 1st node after it began.
    """
    count, (intervals, size, _), d = len(times), free.shape, normals.shape[1]
    start, thrust = np.zeros((count, size)), np.zeros((count, intervals * d))
    phi, push = np.zeros((d, size)), np.zeros((d, d))
    normal, along = np.zeros(d), np.empty(size)
    for row in range(count):
        last = min(int(times[row] / dt), intervals - 1)
        _moves(mean_motion, times[row] - last * dt, phi, push)
        angle, face = phase + rate * times[row], faces[row]
        c, s = math.cos(angle), math.sin(angle)
        x, y = out_of_body(c, s, normals[face, 0], normals[face, 1])
        normal[0], normal[1] = -x, -y
        if d == 3:
            normal[2] = -normals[face, 2]
        for j in range(size):
            along[j] = 0.0
            for i in range(d):
                along[j] += normal[i] * phi[i, j]
        for j in range(size):
            for i in range(size):
                start[row, j] += along[i] * free[last, i, j]
        for k in range(last):
            for j in range(d):
                total = 0.0
                for i in range(size):
                    total += along[i] * pushed[last - 1 - k, i, j]
                thrust[row, k * d + j] = total
        for j in range(d):
            for i in range(d):
                thrust[row, last * d + j] += normal[i] * push[i, j]
    return start, thrust
