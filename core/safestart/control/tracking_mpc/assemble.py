"""The program of one step from the attitudes ahead, compiled: rows, Hessian, and the effect of the start.

Variables are z = (w_0 .. w_{Nc-1}, theta): deviations of the free inputs from the equilibrium's, LVLH axes, and the
artificial reference, body axes. Rows, in this order, for F faces and H rows that limit theta alone:

    corridor at steps f .. N_p - 1 (F rows each), inputs at steps 0 .. N_p - 1 (S rows each, both sides), theta (H).

No input affects the corridor rows before step f (2 with impulses, 1 with held thrust), which are checked separately. At
step N_p the deviation is 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from safestart.control.tracking_mpc.active_set import add_scaled
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled


class Fixed(NamedTuple):
    """What is the same in every step: the motion's maps, the condensed prediction, its cost, and the rows' normals.

    ``weights`` (m,), ``flat`` (2, 6, 3) and ``motion`` (3, 3, 3) are those of :func:`equilibria`; ``reach`` and
    ``push`` (N_p, 3, c) give positions and inputs from (e_0, w); ``cost`` (c, c); ``tau`` weighs theta; ``normals``
    (F, 3), ``sides`` (S, 3) and ``limits`` (H, 3), body axes, are the rows on positions, inputs and theta alone.
    """

    weights: Floats
    flat: Floats
    motion: Floats
    reach: Floats
    push: Floats
    cost: Floats
    tau: float
    normals: Floats
    sides: Floats
    limits: Floats


@compiled(error_model="numpy", fastmath={"contract", "reassoc", "nsz"})
def three(left, right, out):  # type: ignore[no-untyped-def]
    """Out (3, c) = left (3, 3) right (3, c)."""
    for i in range(3):
        a, b, c = left[i, 0], left[i, 1], left[i, 2]
        for k in range(right.shape[1]):
            out[i, k] = a * right[0, k] + b * right[1, k] + c * right[2, k]


@compiled(error_model="numpy")
def equilibria(attitudes, weights, flat, motion, start, spots, held):  # type: ignore[no-untyped-def]
    """Maps of theta, from the ``attitudes`` at this step and after it; see :mod:`equilibrium` for the formulas.

    ``start`` (6, 3): x_e(0), LVLH. ``spots`` (N_p, 3, 3): position of x_e(j) in the body. ``held`` (N_p, 3, 3): u_e(j),
    body axes. ``motion`` (3, 3, 3) is P, Q, R; ``flat`` (2, 6, 3) is X0, X1.
    """
    total, points = len(held), len(weights)
    found, back = np.zeros((total + 2, 3, 3)), np.empty((3, 3))
    for j in range(total + 2):
        for w in range(points):
            for i in range(3):
                for k in range(3):
                    found[j, i, k] += weights[w] * attitudes[j + w, k, i]
    for i in range(6):
        for k in range(3):
            value = 0.0
            for b in range(3):
                value += flat[0, i, b] * found[0, b, k] + flat[1, i, b] * found[1, b, k]
            start[i, k] = value
    for j in range(total):
        for i in range(3):
            for k in range(3):
                value = 0.0
                for s in range(3):
                    for b in range(3):
                        value += motion[s, i, b] * found[j + 2 - s, b, k]
                back[i, k] = value
        three(attitudes[j], back, held[j])
        if points == 1:
            for i in range(3):
                for k in range(3):
                    spots[j, i, k] = 1.0 if i == k else 0.0
            continue
        for i in range(3):
            for k in range(3):
                value = 0.0
                for b in range(3):
                    value += flat[0, i, b] * found[j, b, k] + flat[1, i, b] * found[j + 1, b, k]
                back[i, k] = value
        three(attitudes[j], back, spots[j])


@compiled(error_model="numpy")
def place(source, start, column, rows, shift):  # type: ignore[no-untyped-def]
    """One row from ``source`` (m,) on (e_0, w): writes its part on z to ``rows`` and its part on x_0 to ``shift``."""
    free = len(source) - 6
    for k in range(free):
        rows[k, column] = source[6 + k]
    for i in range(3):
        value = 0.0
        for k in range(6):
            value += source[k] * start[k, i]
        rows[free + i, column] = -value
    for k in range(6):
        shift[k, column] = source[k]


@compiled(error_model="numpy", fastmath={"contract", "reassoc", "nsz"})
def place_all(turned, normals, spot, start, at, rows, shift, face):  # type: ignore[no-untyped-def]
    """Write from column ``at`` on one row for each of ``normals`` (F, 3), body axes; returns the column after them.

    ``turned`` (3, m) is the limited vector from (e_0, w), ``spot`` (3, 3) its part of theta; ``face`` (m,) is scratch.
    """
    free = len(face) - 6
    for f in range(len(normals)):
        face[:] = 0.0
        for i in range(3):
            if normals[f, i] != 0.0:
                add_scaled(face, turned[i], normals[f, i])
        place(face, start, at, rows, shift)
        for i in range(3):
            for k in range(3):
                rows[free + k, at] += normals[f, i] * spot[i, k]
        at += 1
    return at


@compiled(error_model="numpy", fastmath={"contract", "reassoc", "nsz"})
def assemble(attitudes, fixed, start, spots, held, rows, shift, hessian, slope):  # type: ignore[no-untyped-def]
    """Fill ``rows`` (n, R), ``shift`` (6, R), ``hessian`` (n, n) and ``slope`` (n, 6), and the maps of theta.

    A row's value is rows' z + shift' x_0, the gradient at z = 0 is slope x_0. ``attitudes`` (N_p + 1 + m, 3, 3) are
    those at this step and after it; ``start``, ``spots`` and ``held`` become those of :func:`equilibria`.
    """
    weights, flat, motion, reach, push, cost, tau, normals, sides, limits = fixed
    total, m = len(push), cost.shape[0]
    free = m - 6
    equilibria(attitudes, weights, flat, motion, start, spots, held)
    turned, face = np.empty((3, m)), np.empty(m)
    at = 0
    for j in range(2 if len(weights) == 1 else 1, total):
        three(attitudes[j], reach[j], turned)
        at = place_all(turned, normals, spots[j], start, at, rows, shift, face)
    for j in range(total):
        three(attitudes[j], push[j], turned)
        at = place_all(turned, sides, held[j], start, at, rows, shift, face)
    for f in range(len(limits)):
        rows[:free, at] = 0.0
        shift[:, at] = 0.0
        for k in range(3):
            rows[free + k, at] = limits[f, k]
        at += 1
    # e_0 = x_0 - start theta turns the form in (e_0, w) into one in (w, theta).
    for i in range(free):
        for k in range(free):
            hessian[i, k] = cost[6 + i, 6 + k]
        for k in range(6):
            slope[i, k] = cost[6 + i, k]
        for k in range(3):
            value = 0.0
            for b in range(6):
                value -= cost[6 + i, b] * start[b, k]
            hessian[i, free + k] = hessian[free + k, i] = value
    for i in range(3):
        for k in range(6):
            value = 0.0
            for b in range(6):
                value -= start[b, i] * cost[b, k]
            slope[free + i, k] = value
        for k in range(3):
            value = tau if i == k else 0.0
            for b in range(6):
                value -= slope[free + i, b] * start[b, k]
            hessian[free + i, free + k] = value
