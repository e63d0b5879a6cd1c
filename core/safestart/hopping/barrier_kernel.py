"""The rows of the hopping MPC's barrier, compiled."""

from __future__ import annotations

import math

import numpy as np

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled


@compiled()
def barrier_rows(
    phi: Floats,
    state: Floats,
    impulse: Floats,
    keep_out: float,
    kappa: float,
    alpha: float,
    noise: Floats,
    values: Floats,
    slopes: Floats,
) -> None:
    """Values (T,), m, and slopes (T, 3) of the barrier's rows; ``phi`` (T, 6, 6), ``noise`` (4,): position, velocity,
    share, angle."""
    scale = 2.0 * alpha * keep_out
    after, there, q = state.copy(), np.empty(6), np.empty(6)
    size = 0.0
    for i in range(3):
        after[3 + i] += impulse[i]
        size += impulse[i] * impulse[i]
    for t in range(len(phi)):
        here = phi[t]
        for i in range(6):
            there[i] = 0.0
            for j in range(6):
                there[i] += here[i, j] * after[j]
        square = there[0] ** 2 + there[1] ** 2 + there[2] ** 2
        distance = max(math.sqrt(square), 1e-9)
        ahead, fast, still = 0.0, 0.0, 0.0
        for j in range(6):
            q[j] = (there[0] * here[0, j] + there[1] * here[1, j] + there[2] * here[2, j]) / distance
        for j in range(3):
            ahead += q[3 + j] * impulse[j]
            still += q[j] * q[j]
            fast += q[3 + j] * q[3 + j]
        across = max(size * fast - ahead * ahead, 0.0)
        spread = math.sqrt(
            noise[0] ** 2 * still + noise[1] ** 2 * fast + noise[2] ** 2 * ahead**2 + noise[3] ** 2 * across
        )
        radius = keep_out + kappa * spread
        closing = there[0] * there[3] + there[1] * there[4] + there[2] * there[5]
        values[t] = (2.0 * closing + alpha * (square - radius * radius)) / scale
        for j in range(3):
            slope = 0.0
            for i in range(3):
                slope += (there[3 + i] + alpha * there[i]) * here[i, 3 + j] + there[i] * here[3 + i, 3 + j]
            slopes[t, j] = 2.0 * slope / scale
