"""The program of one step of the hopping MPC, assembled and solved by compiled code: the same as in ``hop_program``.

What the compiled method does not end well, or what meets the bounds on impulses, which it leaves out, Clarabel solves.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.hopping.hop_constraints import Flags
from safestart.hopping.hop_program import HopProgram, Solved, Weights
from safestart.hopping.hop_solver import solved
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

_NO_ROWS = np.zeros((0, 3)), np.zeros(0)
_NO_BOX = np.zeros(3), math.inf


class CompiledProgram:
    """The program for the hops that remain, from one state; arguments as those of :class:`HopProgram`."""

    def __init__(
        self,
        mean_motion: float,
        angle_axes: Floats,
        distances: Floats,
        times: Floats,
        state: Floats,
        weights: Weights,
    ) -> None:
        self.asked = mean_motion, angle_axes, distances, times, state, weights
        self.weights, w = weights, weights
        costs = np.array([w.track, w.terminal, w.soft, w.position, w.speed])
        self.parts = assembled(
            mean_motion,
            np.ascontiguousarray(angle_axes),
            np.ascontiguousarray(distances, dtype=np.float64),
            np.ascontiguousarray(times, dtype=np.float64),
            np.ascontiguousarray(state, dtype=np.float64),
            costs,
        )

    def solve(
        self, barrier: tuple[Floats, Floats] | None = None, near: tuple[Floats, float] | None = None
    ) -> Solved:
        """As :meth:`HopProgram.solve`."""
        w = self.weights
        lean, level = barrier or _NO_ROWS
        centre, size = near or _NO_BOX
        u, good, _ = solved(
            *self.parts,
            np.ascontiguousarray(lean),
            np.ascontiguousarray(level),
            100.0 * w.soft,
            np.ascontiguousarray(centre),
            float(size),
        )
        if not good or float(np.abs(u).max()) > w.most or float(np.abs(u).sum()) > w.budget:
            return HopProgram(*self.asked).solve(barrier, near)
        return Solved(u.reshape(-1, 3), True)


@compiled()
def _transition(n: float, t: float, phi: Floats) -> None:
    """CWH transition matrix (6, 6)."""
    tau = n * t
    s, c = math.sin(tau), math.cos(tau)
    # 1 - cos without cancellation.
    d = 2.0 * math.sin(0.5 * tau) ** 2
    phi[:] = 0.0
    phi[0, 0], phi[0, 3], phi[0, 4] = 1.0 + 3.0 * d, s / n, 2.0 * d / n
    phi[1, 0], phi[1, 1], phi[1, 3], phi[1, 4] = 6.0 * (s - tau), 1.0, -2.0 * d / n, 4.0 * s / n - 3.0 * t
    phi[2, 2], phi[2, 5] = c, s / n
    phi[3, 0], phi[3, 3], phi[3, 4] = 3.0 * n * s, c, 2.0 * s
    phi[4, 0], phi[4, 3], phi[4, 4] = -6.0 * n * d, -2.0 * s, 4.0 * c - 3.0
    phi[5, 2], phi[5, 5] = -n * s, c


@compiled()
def assembled(
    n: float, axes: Floats, distances: Floats, times: Floats, state: Floats, costs: Floats
) -> tuple[Floats, Floats, Floats, Floats, Floats, Flags, Floats]:
    """Cost Q (C, C), q (C,); soft rows A (R, C), their levels, tolerances, whether two-sided, weights, all (R,).

    ``costs`` (5,): track, terminal, soft, position, speed of :class:`Weights`.
    """
    track, terminal, soft, position, speed = costs
    hops = len(times)
    count = 3 * (hops + 1)
    along, across, out = axes[0], axes[1], axes[2]
    flat = abs(along[0]) < 1e-9
    reach, free, phi = np.zeros((hops + 1, 6, count)), np.zeros((hops + 1, 6)), np.empty((6, 6))
    free[0] = state
    for j in range(hops):
        _transition(n, times[j], phi)
        reach[j + 1] = phi @ reach[j]
        free[j + 1] = phi @ free[j]
        for i in range(6):
            for k in range(3):
                reach[j + 1, i, 3 * j + k] += phi[i, 3 + k]
    rows = 3 * hops + 3 + (hops - 1 if flat and hops > 1 else 0)
    a, level, edge = np.zeros((rows, count)), np.zeros(rows), np.zeros(rows)
    both, weight = np.ones(rows, dtype=np.bool_), np.zeros(rows)
    q2, q, tracked = np.zeros((count, count)), np.zeros(count), np.empty(count)
    at = 0
    for j in range(1, hops + 1):
        for which in range(3):
            axis = across if which == 0 else along if which == 1 else out
            moving = which == 1 or (which == 2 and flat)
            first = 3 if moving else 0
            for i in range(3):
                level[at] += axis[i] * free[j, first + i]
                for k in range(count):
                    a[at, k] += axis[i] * reach[j, first + i, k]
            edge[at] = speed if moving else position
            weight[at] = soft / n if moving else soft
            at += 1
        cost = terminal if j == hops else track
        target = distances[j - 1]
        tracked[:] = 0.0
        for i in range(3):
            target -= along[i] * free[j, i]
            for k in range(count):
                tracked[k] += along[i] * reach[j, i, k]
        for k in range(count):
            q[k] -= 2.0 * cost * target * tracked[k]
            for e in range(count):
                q2[k, e] += 2.0 * cost * tracked[k] * tracked[e]
    for i in range(3):
        for k in range(count):
            a[at, k] = reach[hops, 3 + i, k]
        a[at, count - 3 + i] += 1.0
        level[at], edge[at], weight[at] = free[hops, 3 + i], speed, soft / n
        at += 1
    if flat:
        for j in range(1, hops):
            for i in range(3):
                level[at] += along[i] * (2.0 * free[j, i] - free[j - 1, i] - free[j + 1, i])
                for k in range(count):
                    a[at, k] += along[i] * (2.0 * reach[j, i, k] - reach[j - 1, i, k] - reach[j + 1, i, k])
            both[at], weight[at] = False, soft
            at += 1
    return q2, q, a, level, edge, both, weight
