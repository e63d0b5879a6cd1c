"""A primal-dual interior-point method for the quadratic program of one step of the hopping MPC, compiled.

With u = p - m, p and m >= 0, and slacks s of the soft rows and t of the barrier, it minimises

    sum(p + m) + u' Q u / 2 + q' u + w' s + W t
    s + A u + l + e >= 0,  s - A u - l + e >= 0 (two-sided rows),  t + G u_0 + g >= 0,  |u_0 - c| <= size,  s, t >= 0.

Newton's system of all unknowns reduces to one of the size of u: slacks and the split are eliminated by hand. Predictor
and corrector after Mehrotra (Nocedal and Wright, Numerical Optimization, algorithm 16.4). Bounds on single impulses and
on their sum are not in it: the caller looks at them afterwards.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.hopping.hop_constraints import Flags, factored, linear_parts, pulled_back, substituted
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

_STEPS = 60
_GAP = 1e-9
"""Mean product of a constraint with its multiplier at which the method stops, over the cost's own scale."""
_FIT = 1e-9
_BACK = 0.995


@compiled()
def solved(
    q2: Floats,
    q: Floats,
    a: Floats,
    level: Floats,
    edge: Floats,
    both: Flags,
    weight: Floats,
    g: Floats,
    g_level: Floats,
    heavy: float,
    centre: Floats,
    size: float,
) -> tuple[Floats, bool, int]:
    """The impulses u (C,), whether the method converged, and its steps.

    ``q2`` (C, C), ``q`` (C,); ``a`` (R, C) with ``level``, ``edge``, ``weight`` (R,) of the soft rows, ``both`` (R,):
    two-sided ones; ``g`` (B, 3), ``g_level`` (B,) and the weight ``heavy`` of the barrier, B may be 0; ``centre`` (3,)
    and ``size`` of the box of the first impulse; no box where ``size`` is infinite.
    """
    c, r, b = len(q), len(a), len(g)
    boxed = math.isfinite(size)
    count = 2 * c + 3 * r + 1 + b + 6
    live = np.ones(count, dtype=np.bool_)
    h = np.zeros(count)
    at = 2 * c + r
    for i in range(r):
        h[at + i], h[at + r + i] = level[i] + edge[i], edge[i] - level[i]
        live[at + r + i] = both[i]
    at += 2 * r
    if b == 0:
        live[at] = False
    for i in range(b):
        h[at + 1 + i] = g_level[i]
    at += 1 + b
    for i in range(3):
        live[at + i] = live[at + 3 + i] = boxed
        if boxed:
            h[at + i], h[at + 3 + i] = size + centre[i], size - centre[i]
    p, m, s, t = np.ones(c), np.ones(c), np.ones(r), 1.0
    if boxed:
        for i in range(3):
            p[i], m[i] = 1.0 + max(centre[i], 0.0), 1.0 + max(-centre[i], 0.0)
    u = p - m
    y, lam, row = np.ones(count), np.ones(count), np.zeros(count)
    linear_parts(u, p, m, s, t, a, both, g, boxed, row)
    for i in range(count):
        y[i] = max(row[i] + h[i], 1.0) if live[i] else 1.0
        lam[i] = 1.0 if live[i] else 0.0
    many = live.sum()
    scale = 1.0 + max(np.abs(q).max(), heavy if b else 0.0)
    for i in range(r):
        scale = max(scale, 1.0 + weight[i])
    fit = 1.0 + np.abs(h).max()
    matrix, factor = np.empty((c, c)), np.empty((c, c))
    pull, lean, right, step = np.empty(c), np.empty(3), np.empty(c), np.empty(c)
    w, res, extra = np.zeros(count), np.zeros(count), np.zeros(count)
    dy, dlam, drow = np.zeros(count), np.zeros(count), np.zeros(count)
    dp, dm, ds = np.empty(c), np.empty(c), np.empty(r)
    one, two = 2 * c, 2 * c + r
    three, four = two + r, two + 2 * r
    for k in range(_STEPS):
        # Residuals of the constraints and of stationarity.
        linear_parts(u, p, m, s, t, a, both, g, boxed, row)
        gap, off = 0.0, 0.0
        for i in range(count):
            res[i] = row[i] + h[i] - y[i] if live[i] else 0.0
            off = max(off, abs(res[i]))
            gap += y[i] * lam[i] if live[i] else 0.0
        gap /= many
        total = pulled_back(c, a, both, g, boxed, lam, pull)
        grad = q2 @ u + q
        stray = abs(heavy - total) if b else 0.0
        for i in range(c):
            stray = max(
                stray, abs(1.0 + grad[i] - pull[i] - lam[i]), abs(1.0 - grad[i] + pull[i] - lam[c + i])
            )
        for i in range(r):
            back = lam[three + i] if both[i] else 0.0
            stray = max(stray, abs(weight[i] - lam[one + i] - lam[two + i] - back))
        if gap <= _GAP and off <= _FIT * fit and stray <= _FIT * scale:
            return u, True, k
        # The reduced matrix.
        for i in range(count):
            w[i] = lam[i] / y[i] if live[i] else 0.0
        matrix[:] = q2
        for i in range(r):
            w4, w5 = w[two + i], w[three + i]
            share = w4 + w5 - (w4 - w5) ** 2 / (w[one + i] + w4 + w5)
            for j in range(c):
                v = share * a[i, j]
                if v != 0.0:
                    for e in range(j + 1):
                        matrix[j, e] += v * a[i, e]
        by_t = w[four]
        lean[:] = 0.0
        for i in range(b):
            v = w[four + 1 + i]
            by_t += v
            for j in range(3):
                lean[j] += v * g[i, j]
                for e in range(j + 1):
                    matrix[j, e] += v * g[i, j] * g[i, e]
        for j in range(3 if b else 0):
            for e in range(j + 1):
                matrix[j, e] -= lean[j] * lean[e] / by_t
        if boxed:
            for j in range(3):
                matrix[j, j] += w[four + 1 + b + j] + w[four + 4 + b + j]
        for j in range(c):
            matrix[j, j] += w[j] * w[c + j] / (w[j] + w[c + j])
        factor[:] = matrix
        if not factored(factor):
            return u, False, k
        sigma = 0.0
        for phase in range(2):
            # lam + dlam = (mu - dy dlam)/y - w (res + drow), predictor: mu = 0.
            for i in range(count):
                extra[i] = 0.0
                if live[i]:
                    target = sigma * gap - (dy[i] * dlam[i] if phase else 0.0)
                    extra[i] = target / y[i] - w[i] * res[i]
            total = pulled_back(c, a, both, g, boxed, extra, pull)
            # Right sides of p, m; of s and t through their elimination.
            for i in range(c):
                right[i] = pull[i]
            rt = total - heavy
            for i in range(r):
                w4, w5 = w[two + i], w[three + i]
                rs = extra[one + i] + extra[two + i] + (extra[three + i] if both[i] else 0.0) - weight[i]
                ds[i] = rs
                v = (w4 - w5) * rs / (w[one + i] + w4 + w5)
                for j in range(c):
                    right[j] -= v * a[i, j]
            if b:
                for j in range(3):
                    right[j] -= lean[j] * rt / by_t
            for i in range(c):
                r1 = extra[i] - 1.0 - grad[i] + right[i]
                r2 = extra[c + i] - 1.0 + grad[i] - right[i]
                both_sides = r1 + r2
                step[i] = r1 - w[i] * both_sides / (w[i] + w[c + i])
                dm[i] = both_sides
            substituted(factor, step)
            for i in range(c):
                dp[i] = (w[c + i] * step[i] + dm[i]) / (w[i] + w[c + i])
                dm[i] = dp[i] - step[i]
            for i in range(r):
                w4, w5 = w[two + i], w[three + i]
                value = 0.0
                for j in range(c):
                    value += a[i, j] * step[j]
                ds[i] = (ds[i] - (w4 - w5) * value) / (w[one + i] + w4 + w5)
            dt = 0.0
            if b:
                dt = (rt - lean[0] * step[0] - lean[1] * step[1] - lean[2] * step[2]) / by_t
            linear_parts(step, dp, dm, ds, dt, a, both, g, boxed, drow)
            most, most_dual = 1.0, 1.0
            for i in range(count):
                if live[i]:
                    change = drow[i] + res[i]
                    new = extra[i] - w[i] * drow[i] - lam[i]
                    dy[i], dlam[i] = change, new
                    if change < 0.0:
                        most = min(most, -y[i] / change)
                    if new < 0.0:
                        most_dual = min(most_dual, -lam[i] / new)
            if phase == 0:
                after = 0.0
                for i in range(count):
                    if live[i]:
                        after += (y[i] + most * dy[i]) * (lam[i] + most_dual * dlam[i])
                sigma = (after / many / gap) ** 3
        most, most_dual = min(_BACK * most, 1.0), min(_BACK * most_dual, 1.0)
        # A quadratic cost needs one length for both.
        length = min(most, most_dual)
        for i in range(c):
            p[i] += length * dp[i]
            m[i] += length * dm[i]
            u[i] = p[i] - m[i]
        for i in range(r):
            s[i] += length * ds[i]
        t += length * dt
        for i in range(count):
            if live[i]:
                y[i] += length * dy[i]
                lam[i] += length * dlam[i]
    return u, False, _STEPS
