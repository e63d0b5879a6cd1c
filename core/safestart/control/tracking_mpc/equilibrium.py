"""Equilibrium trajectories: a point theta fixed in the body, followed exactly (corrects paper 002, eqs. 24-26).

The paper's kernel solves x = A(k) x + B(k) u, which is not a trajectory, because v_e changes from step to step. With
r(k) = C(k)^T theta, C(k) (LVLH to body) the attitude at k T, and s(k) the sum of weights[i] r(k+i),

    x_e(k) = X0 s(k) + X1 s(k+1),    u_e(k) = P s(k+2) + Q s(k+1) + R s(k)

is a trajectory, with the matrices of :class:`Sampled`. Impulses pass through theta at every node (s = r). Held thrust
cannot without inputs that alternate; it passes beside theta, by about n T / 8 plus a fourth of the fourth power of the
turn per step, times that turn, per metre of |theta|.
"""

from __future__ import annotations

import numpy as np

from safestart.control.tracking_mpc.sampled import Sampled
from safestart.model.scenario import Floats


def flats(motion: Sampled, attitudes: Floats) -> Floats:
    """(K - m + 1, 3, 3): theta to s(k), LVLH, for attitudes (K, 3, 3) at the nodes and m weights."""
    back = attitudes.swapaxes(1, 2)
    count = len(attitudes) - len(motion.weights) + 1
    if len(motion.weights) == 1:
        return back
    return sum((w * back[i : i + count] for i, w in enumerate(motion.weights)), np.zeros((count, 3, 3)))


def states(motion: Sampled, attitudes: Floats) -> Floats:
    """(K - m, 6, 3): theta to the LVLH state x_e(k)."""
    found = flats(motion, attitudes)
    out: Floats = motion.flat[0] @ found[:-1] + motion.flat[1] @ found[1:]
    return out


def places(motion: Sampled, attitudes: Floats) -> Floats:
    """(K - m, 3, 3): theta to the position of x_e(k) in the body, the identity with impulses."""
    there = states(motion, attitudes)[:, :3]
    out: Floats = attitudes[: len(there)] @ there
    return out


def inputs(motion: Sampled, attitudes: Floats) -> Floats:
    """(K - m - 1, 3, 3): theta to u_e(k) in body axes, m/s per m."""
    found = flats(motion, attitudes)
    lvlh = motion.p @ found[2:] + motion.q @ found[1:-1] + motion.r @ found[:-2]
    out: Floats = attitudes[: len(lvlh)] @ lvlh
    return out
