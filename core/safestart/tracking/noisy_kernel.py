"""A flight with errors, compiled: attitudes ahead predicted from what is measured, the step, the truth, the filter."""

from __future__ import annotations

import math

import numpy as np

from safestart.attitude.turn_kernel import into_body
from safestart.control.tracking_mpc.assemble import assemble
from safestart.control.tracking_mpc.step_kernel import INFEASIBLE, SOLVED, soften, solve_from
from safestart.runtime.kernels.compiled import compiled

HARD, SOFT, TUBE = 0, 1, 2
_FIXED = 1e-6
"""Allowed violation, m, of rows that no input affects: the attitudes ahead are right to 1e-7 rad only."""
_FINEST = 0.1
"""Largest turn of an integration step, rad: the fourth-order method is then off by less than 1e-7 rad in a step."""


@compiled(error_model="numpy")
def body_rates(w, inertia, inverse, out):  # type: ignore[no-untyped-def]
    """Euler's equations: out = -I^-1 (w x I w)."""
    a, b, c = 0.0, 0.0, 0.0
    for k in range(3):
        a += inertia[0, k] * w[k]
        b += inertia[1, k] * w[k]
        c += inertia[2, k] * w[k]
    x, y, z = w[1] * c - w[2] * b, w[2] * a - w[0] * c, w[0] * b - w[1] * a
    for i in range(3):
        out[i] = -(inverse[i, 0] * x + inverse[i, 1] * y + inverse[i, 2] * z)


@compiled(error_model="numpy")
def turning(w, c, out):  # type: ignore[no-untyped-def]
    """Out = -[w]x C."""
    for k in range(3):
        out[0, k] = w[2] * c[1, k] - w[1] * c[2, k]
        out[1, k] = w[0] * c[2, k] - w[2] * c[0, k]
        out[2, k] = w[1] * c[0, k] - w[0] * c[1, k]


@compiled(error_model="numpy")
def predict(first, rate, inertia, inverse, orbit, period, out):  # type: ignore[no-untyped-def]
    """Attitudes ``out`` (K, 3, 3), LVLH to body, from the ``first`` one and an inertial body ``rate`` on (RK4)."""
    c, w = first.copy(), rate.copy()
    size = math.sqrt(w[0] ** 2 + w[1] ** 2 + w[2] ** 2)
    parts = max(1, math.ceil(size * period / _FINEST))
    h = period / parts
    dw, dc, w1, c1 = np.empty((4, 3)), np.empty((4, 3, 3)), np.empty(3), np.empty((3, 3))
    out[0] = first
    for k in range(1, len(out)):
        for _ in range(parts):
            for stage in range(4):
                share = 0.0 if stage == 0 else (h if stage == 3 else 0.5 * h)
                for i in range(3):
                    w1[i] = w[i] + (share * dw[stage - 1, i] if stage else 0.0)
                    for j in range(3):
                        c1[i, j] = c[i, j] + (share * dc[stage - 1, i, j] if stage else 0.0)
                body_rates(w1, inertia, inverse, dw[stage])
                turning(w1, c1, dc[stage])
            for i in range(3):
                w[i] += h / 6.0 * (dw[0, i] + 2.0 * dw[1, i] + 2.0 * dw[2, i] + dw[3, i])
                for j in range(3):
                    c[i, j] += h / 6.0 * (dc[0, i, j] + 2.0 * dc[1, i, j] + 2.0 * dc[2, i, j] + dc[3, i, j])
        # C R', R the turn of LVLH about z meanwhile: each row of C is turned.
        cosine, sine = math.cos(orbit * period * k), math.sin(orbit * period * k)
        for i in range(3):
            out[k, i, 0], out[k, i, 1] = into_body(cosine, sine, c[i, 0], c[i, 1])
            out[k, i, 2] = c[i, 2]


@compiled(error_model="numpy")
def plan_inputs(attitudes, start, held, push, z, state, out):  # type: ignore[no-untyped-def]
    """All inputs ``out`` (N_p, 3), LVLH axes, of the plan ``z`` from ``state`` (6,); maps of theta as assembled."""
    n = len(z)
    theta = z[n - 3 :]
    deviation = np.empty(push.shape[2])
    for i in range(6):
        deviation[i] = state[i]
        for k in range(3):
            deviation[i] -= start[i, k] * theta[k]
    for k in range(n - 3):
        deviation[6 + k] = z[k]
    for j in range(len(push)):
        for i in range(3):
            value = 0.0
            for k in range(3):
                for b in range(3):
                    value += attitudes[j, k, i] * held[j, k, b] * theta[b]
            for k in range(push.shape[2]):
                value += push[j, i, k] * deviation[k]
            out[j, i] = value


@compiled(error_model="numpy")
def overstepped(attitudes, a, nodes, normals, offsets, state):  # type: ignore[no-untyped-def]
    """How far ``state`` (6,) oversteps the corridor at the ``nodes`` (1 or 2) that no input reaches, m."""
    worst = -np.inf
    body, place = np.empty(3), np.empty(3)
    for node in range(nodes):
        for i in range(3):
            place[i] = state[i]
            if node == 1:
                place[i] = 0.0
                for b in range(6):
                    place[i] += a[i, b] * state[b]
        for i in range(3):
            body[i] = 0.0
            for b in range(3):
                body[i] += attitudes[node, i, b] * place[b]
        for f in range(len(normals)):
            over = -offsets[f]
            for i in range(3):
                over += normals[f, i] * body[i]
            worst = max(worst, over)
    return worst


@compiled(error_model="numpy")
def fly_noisy(  # type: ignore[no-untyped-def]
    start,
    truth,
    rates,
    inertia,
    inverse,
    orbit,
    period,
    a,
    b_matrix,
    gain,
    variant,
    navigation,
    sizes,
    fixed,
    ball,
    offsets,
    low,
    high,
    give,
):
    """Fly len(truth) - 1 steps; returns (least slack, largest input, impulse, last range, steps without a plan).

    ``truth`` (K + 1, 3, 3) and ``rates`` (K + 1, 3): the attitude as it is and the inertial rate as it is believed.
    ``navigation`` (K + 1, 6): errors of what is measured; ``sizes`` (K,): factor on each input. ``gain`` (6, 6) is
    the filter's, ``fixed`` the program's (:class:`Fixed`); ``ball``: its inputs lie in a ball, else in a box. A step
    without a plan that keeps every row, those of this node and the next among them, follows the last plan (HARD), or
    the one of least violation.
    """
    weights, push, normals = fixed.weights, fixed.push, fixed.normals
    steps, total, n = len(truth) - 1, len(push), fixed.cost.shape[0] - 3
    count, faces = len(high), len(normals)
    rows, shift = np.empty((n, count)), np.empty((6, count))
    hessian, slope = np.empty((n, n)), np.empty((n, 6))
    z, dual = np.empty(n), np.empty(count)
    attitudes = np.empty((total + 1 + len(weights), 3, 3))
    at_start, spots, held = np.empty((6, 3)), np.empty((total, 3, 3)), np.empty((total, 3, 3))
    fixed_nodes = 2 if len(weights) == 1 else 1
    planned = np.zeros((total, 3))
    follow = total
    state, estimate = start.copy(), start + navigation[0]
    least, largest, impulse, unplanned = np.inf, 0.0, 0.0, 0
    given, body = np.empty(3), np.empty(3)
    for k in range(steps + 1):
        for i in range(3):
            body[i] = 0.0
            for b in range(3):
                body[i] += truth[k, i, b] * state[b]
        for f in range(faces):
            slack = offsets[f]
            for i in range(3):
                slack -= normals[f, i] * body[i]
            least = min(least, slack)
        if k == steps:
            break
        predict(truth[k], rates[k], inertia, inverse, orbit, period, attitudes)
        assemble(attitudes, fixed, at_start, spots, held, rows, shift, hessian, slope)
        status, _ = solve_from(rows, shift, hessian, slope, low, high, estimate, z, dual)
        outside = overstepped(attitudes, a, fixed_nodes, normals, offsets, estimate) > _FIXED
        if status != SOLVED or outside:
            unplanned += 1
            if variant == HARD:
                status = INFEASIBLE
            elif status != SOLVED:
                status, _t = soften(rows, shift, hessian, slope, low, high, give, estimate, z, dual)
        if status == SOLVED:
            plan_inputs(attitudes, at_start, held, push, z, estimate, planned)
            follow = 0
        else:
            follow += 1
        for i in range(3):
            given[i] = planned[follow, i] if follow < total else 0.0
        size = 0.0
        for i in range(3):
            pushed = 0.0
            for b in range(3):
                pushed += truth[k, i, b] * given[b]
            if not ball:
                largest = max(largest, abs(pushed))
            size += pushed * pushed
        if ball:
            largest = max(largest, math.sqrt(size))
        impulse += math.sqrt(size)
        moved, expected = np.zeros(6), np.zeros(6)
        for i in range(6):
            for b in range(6):
                moved[i] += a[i, b] * state[b]
                expected[i] += a[i, b] * estimate[b]
            for b in range(3):
                moved[i] += sizes[k] * b_matrix[i, b] * given[b]
                expected[i] += b_matrix[i, b] * given[b]
        state = moved
        for i in range(6):
            estimate[i] = expected[i]
            for b in range(6):
                estimate[i] += gain[i, b] * (state[b] + navigation[k + 1, b] - expected[b])
    return least, largest, impulse, math.sqrt(state[0] ** 2 + state[1] ** 2 + state[2] ** 2), unplanned
