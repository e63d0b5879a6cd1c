"""Equilibrium trajectories: a point theta fixed in the body, followed exactly (corrects paper 002, eqs. 24-26).

The paper's kernel solves x = A(k) x + B(k) u, which is not a trajectory, because v_e changes from step to step. A
chaser at theta at every node has

    v_e(k) = P [C(k+1)^T - A_rr C(k)^T] theta,    u_e(k) = P r(k+2) + Q r(k+1) + R r(k),  r(k) = C(k)^T theta,

with C(k) (LVLH to body) the attitude at k T and P, Q, R of :class:`Sampled`.
"""

from __future__ import annotations

import numpy as np

from safestart.control.tracking_mpc.sampled import Sampled
from safestart.model.scenario import Floats


def velocities(motion: Sampled, attitudes: Floats) -> Floats:
    """(K - 1, 3, 3): theta to v_e(k), LVLH, for attitudes (K, 3, 3) at the nodes."""
    back = attitudes.swapaxes(1, 2)
    out: Floats = motion.p @ (back[1:] - motion.a[:3, :3] @ back[:-1])
    return out


def states(motion: Sampled, attitudes: Floats) -> Floats:
    """(K - 1, 6, 3): theta to the LVLH state x_e(k)."""
    return np.concatenate([attitudes[:-1].swapaxes(1, 2), velocities(motion, attitudes)], axis=1)


def inputs(motion: Sampled, attitudes: Floats) -> Floats:
    """(K - 2, 3, 3): theta to u_e(k) in body axes, m/s per m."""
    back = attitudes.swapaxes(1, 2)
    lvlh = motion.p @ back[2:] + motion.q @ back[1:-1] + motion.r @ back[:-2]
    out: Floats = attitudes[:-2] @ lvlh
    return out
