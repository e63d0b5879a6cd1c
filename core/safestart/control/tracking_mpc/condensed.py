"""The parts of every step's program that do not depend on the attitude (paper 002, eqs. 8-17, condensed).

With deviations e = x - x_e(theta) and w = u - u_e(theta), both in LVLH axes, e_{j+1} = A e_j + B w_j. So deviations at
all steps, tail inputs and the cost are constant functions of (e_0, w_0 .. w_{Nc-1}), computed once per tuning. Only e_0
= x_0 - x_e(0; theta) and the rotation of each step's rows into the body change.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safestart.control.tracking_mpc.sampled import Sampled
from safestart.model.scenario import Floats


@dataclass(frozen=True)
class Condensed:
    """Maps from (e_0, w), m = 6 + 3 n_c numbers.

    ``reach`` (N_p + 1, 3, m): positions of e_j. ``push`` (N_p, 3, m): w_j. ``cost`` (m, m): the cost's quadratic form.
    ``closed`` (6, 6) is A + B K of the regulator, ``gain`` (3, 6) its K.
    """

    reach: Floats
    push: Floats
    cost: Floats
    closed: Floats
    gain: Floats


def condense(motion: Sampled, n_c: int, n_lqr: int, rho: float) -> Condensed:
    """Roll the deviation out over N_p = n_c + n_lqr + 2 steps."""
    gain, last = motion.regulator(rho), motion.dead_beat()
    b = motion.b
    m, total = 6 + 3 * n_c, n_c + n_lqr + 2
    state = np.zeros((total + 1, 6, m))
    push = np.zeros((total, 3, m))
    state[0, :, :6] = np.eye(6)
    for j in range(total):
        if j < n_c:
            push[j, :, 6 + 3 * j : 9 + 3 * j] = np.eye(3)
        else:
            push[j] = (gain if j < n_c + n_lqr else last) @ state[j]
        state[j + 1] = motion.a @ state[j] + b @ push[j]
    stage, effort = state[:total].reshape(-1, m), push.reshape(-1, m)
    cost = stage.T @ stage + rho * (effort.T @ effort)
    reach = np.ascontiguousarray(state[:, :3])
    return Condensed(reach, push, 0.5 * (cost + cost.T), motion.a + b @ gain, gain)
