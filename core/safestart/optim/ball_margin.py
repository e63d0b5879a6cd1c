"""The largest margin at finitely many rows over thrusts in balls: a compiled primal-dual interior-point method.

Maximise m over points w_k (d,) with |w_k| <= 1, k < N, subject to s_j = c_j + r_j . w - m >= 0, j < J. Multipliers
z_j of the rows and y_k of the balls, written h_k = 1 - |w_k|^2 >= 0, satisfy at the optimum

    sum_j z_j = 1,    sum_j z_j r_jk = 2 y_k w_k,    z_j s_j = 0,    y_k h_k = 0.

Each round takes a Newton step for these equations with their last two relaxed to a falling target, first towards 0,
then with the second-order terms of that trial (Mehrotra, SIAM J. Optim. 2, 1992). The blocks 2 y_k I + 4 y_k / h_k
w_k w_k^T of the balls have closed-form square roots, which leaves a J x J system: J is some twenty, over
long horizons hundreds, N d may be a thousand. All iterates are strictly feasible, and any z > 0 proves a bound, so the
method stops when the two are close.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.optim.dense_kernel import MANY, back, dot, factor, gram
from safestart.runtime.kernels.compiled import compiled

SOLVED, SINGULAR, SLOW, CLOSE = 0, 1, 2, 3
"""Status: within the tolerance; the system of a step was not positive definite; too many iterations; one of these two,
but within 2e-9 of the farthest that thrusts can move a row."""
MOST_ITERATIONS = 40
_USABLE = 2e-9

# The share of the way to the boundary that a step goes, and how far below the rows the first margin lies, as a share
# of the farthest that thrusts can move a row.
_SHARE, _BELOW = 0.99, 0.3
_LEAST_CENTERING = 1e-6
# After a step shorter than this the next one goes for the middle first.
_SHORT, _RECENTERING = 0.1, 0.5
# A ball that does not bind has y near 0: its block is taken no flatter than this share of the mean row, or the system's
# rounding would hide the slacks. It changes the path, not the optimum, but the path comes no closer than about the
# floor itself: many balls, whose rows reach kilometres, and the last digits need a lower one.
_LEAST_CURVATURE, _LESS_CURVATURE = 1e-6, 1e-8
_MANY_BALLS, _FINE_M = 64, 1e-6


@compiled(error_model="numpy")
def _pull(rows: Any, ends: Any, z: Any, pull: Any) -> None:
    """sum_j z_j r_j into ``pull``; row j is 0 from ``ends[j]`` on."""
    for i in range(len(pull)):
        pull[i] = 0.0
    for j in range(len(rows)):
        for i in range(ends[j]):
            pull[i] += z[j] * rows[j, i]


# Two and three components are written out: a loop of two takes ten times as long.
@compiled(error_model="numpy")
def _inner(a: Any, b: Any, d: int, out: Any) -> None:
    """a . b of every ball into ``out``."""
    if d == 2:
        for k in range(len(out)):
            i = 2 * k
            out[k] = a[i] * b[i] + a[i + 1] * b[i + 1]
        return
    if d == 3:
        for k in range(len(out)):
            i = 3 * k
            out[k] = a[i] * b[i] + a[i + 1] * b[i + 1] + a[i + 2] * b[i + 2]
        return
    for k in range(len(out)):
        out[k] = 0.0
        for i in range(d * k, d * k + d):
            out[k] += a[i] * b[i]


@compiled(error_model="numpy")
def _reach(pull: Any, d: int, squares: Any) -> float:
    """Largest pull . w over the balls: the sum of norms."""
    total = 0.0
    _inner(pull, pull, d, squares)
    for k in range(len(squares)):
        total += math.sqrt(squares[k])
    return total


@compiled(error_model="numpy")
def _through_root(v: Any, w: Any, gamma: Any, root: Any, balls: int, d: int, out: Any) -> None:
    """B^(-1/2) v for the first ``balls``, B = 2 y (I + (2 / h) w w^T): ``root`` (I - ``gamma`` w w^T) v."""
    if d == 2:
        for k in range(balls):
            i = 2 * k
            along = (v[i] * w[i] + v[i + 1] * w[i + 1]) * gamma[k]
            out[i] = root[k] * (v[i] - along * w[i])
            out[i + 1] = root[k] * (v[i + 1] - along * w[i + 1])
        return
    if d == 3:
        for k in range(balls):
            i = 3 * k
            along = (v[i] * w[i] + v[i + 1] * w[i + 1] + v[i + 2] * w[i + 2]) * gamma[k]
            out[i] = root[k] * (v[i] - along * w[i])
            out[i + 1] = root[k] * (v[i + 1] - along * w[i + 1])
            out[i + 2] = root[k] * (v[i + 2] - along * w[i + 2])
        return
    for k in range(balls):
        along = 0.0
        for i in range(d * k, d * k + d):
            along += v[i] * w[i]
        along *= gamma[k]
        for i in range(d * k, d * k + d):
            out[i] = root[k] * (v[i] - along * w[i])


@compiled(error_model="numpy")
def largest_margin(constant: Any, rows: Any, d: int, tolerance: float) -> Any:
    """Points w (N d,), weights z (J,) of sum 1, status and the number of iterations.

    ``constant`` (J,) in metres, ``rows`` (J, N d) in metres at |w| = 1. Solved: the bound that z proves is within
    ``tolerance`` (m) of the margin of w.
    """
    count, size = rows.shape
    # No thrust moves a row after its time: what follows its last entry is not computed.
    ends = np.zeros(count, np.int64)
    for j in range(count):
        end = size
        while end > 0 and rows[j, end - 1] == 0.0:
            end -= 1
        ends[j] = (end + d - 1) // d * d
    balls = size // d
    w, pull, q, step = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size)
    trial, along = np.zeros(size), np.zeros(size)
    scaled, system = np.zeros((count, size)), np.zeros((count, count))
    turned = np.zeros((size, count if count > MANY else 0))
    s, ds, dz = np.zeros(count), np.zeros(count), np.zeros(count)
    ds_trial, dz_trial = np.zeros(count), np.zeros(count)
    ones, z, best = np.zeros(count), np.zeros(count), np.zeros(count)
    h, dy, dy_trial = np.zeros(balls), np.zeros(balls), np.zeros(balls)
    gamma, root = np.zeros(balls), np.zeros(balls)
    inners, squares = np.zeros(balls), np.zeros(balls)
    reach = 1e-300
    for j in range(count):
        reach = max(reach, _reach(rows[j], d, squares))
    margin, y = constant[0], np.empty(balls)
    for j in range(count):
        margin, z[j] = min(margin, constant[j]), 1.0 / count
    margin -= _BELOW * reach
    for k in range(balls):
        h[k], y[k] = 1.0, 0.5 * reach / balls
    wide = balls <= _MANY_BALLS and tolerance > _FINE_M
    least = (_LEAST_CURVATURE if wide else _LESS_CURVATURE) * reach / balls
    bound, gap, stuck = np.inf, np.inf, False
    for iteration in range(MOST_ITERATIONS):
        # Slacks anew from the point, so that no rounding gathers; then the bound, the margin and the mean product.
        lowest, product, total, weighted = np.inf, 0.0, 0.0, 0.0
        for j in range(count):
            s[j] = constant[j] + dot(rows[j], w, ends[j]) - margin
            lowest = min(lowest, s[j])
            product += z[j] * s[j]
            total += z[j]
            weighted += z[j] * constant[j]
        _pull(rows, ends, z, pull)
        here = (weighted + _reach(pull, d, squares)) / total
        if here < bound:
            bound = here
            for j in range(count):
                best[j] = z[j] / total
        gap = bound - (margin + lowest)
        if gap <= tolerance:
            return w, best, SOLVED, iteration
        for k in range(balls):
            product += y[k] * h[k]
            longer = h[k] + 2.0 * (1.0 - h[k])
            root[k] = 1.0 / math.sqrt(2.0 * max(y[k], least))
            gamma[k] = 2.0 / (longer * (1.0 + math.sqrt(h[k] / longer)))
        product /= count + balls
        for j in range(count):
            row = scaled[j]
            _through_root(rows[j], w, gamma, root, ends[j] // d, d, row)
            if count <= MANY:
                for i in range(j + 1):
                    system[j, i] = dot(row, scaled[i], min(ends[i], ends[j]))
        if count > MANY:
            gram(scaled, ends, turned, system)
        for j in range(count):
            system[j, j] += s[j] / z[j]
            ones[j] = 1.0
        if not (lowest > 0.0 and factor(system)):
            return w, best, CLOSE if gap <= _USABLE * reach else SINGULAR, iteration
        back(system, ones)
        target, dm = 0.0, 0.0
        primal, dual = 1.0, 1.0
        for phase in range(2):
            # The right-hand sides; in the second phase with the second-order terms of the first one's step.
            for k in range(balls):
                missing = target - y[k] * h[k]
                if phase == 1:
                    for i in range(d * k, d * k + d):
                        missing += trial[i] * (2.0 * w[i] * dy_trial[k] + y[k] * trial[i])
                for i in range(d * k, d * k + d):
                    q[i] = pull[i] - 2.0 * w[i] * (y[k] + missing / h[k])
                    if phase == 1:
                        q[i] -= 2.0 * dy_trial[k] * trial[i]
                dy[k] = missing / h[k]
            _through_root(q, w, gamma, root, balls, d, along)
            for j in range(count):
                dz[j] = target / z[j] - s[j] - dot(scaled[j], along, ends[j])
                if phase == 1:
                    dz[j] -= ds_trial[j] * dz_trial[j] / z[j]
            back(system, dz)
            moved, along_ones = 0.0, 0.0
            for j in range(count):
                moved += dz[j]
                along_ones += ones[j]
            dm = (1.0 - total - moved) / along_ones
            for j in range(count):
                dz[j] += dm * ones[j]
                for i in range(ends[j]):
                    along[i] += scaled[j, i] * dz[j]
            # The step, and how far it stays strictly inside.
            primal, dual = 1.0, 1.0
            _through_root(along, w, gamma, root, balls, d, step)
            _inner(w, step, d, inners)
            _inner(step, step, d, squares)
            for k in range(balls):
                inner, square = inners[k], squares[k]
                dy[k] += 2.0 * y[k] * inner / h[k]
                if dy[k] < 0.0:
                    dual = min(dual, -y[k] / dy[k])
                if square > 0.0:
                    # |w + a step| = 1, without cancellation.
                    radical = math.sqrt(inner * inner + square * h[k])
                    primal = min(
                        primal, h[k] / (inner + radical) if inner > 0.0 else (radical - inner) / square
                    )
            for j in range(count):
                ds[j] = dot(rows[j], step, ends[j]) - dm
                if ds[j] < 0.0:
                    primal = min(primal, -s[j] / ds[j])
                if dz[j] < 0.0:
                    dual = min(dual, -z[j] / dz[j])
            if phase == 0:
                after = 0.0
                for j in range(count):
                    after += (z[j] + dual * dz[j]) * (s[j] + primal * ds[j])
                    ds_trial[j], dz_trial[j] = ds[j], dz[j]
                for k in range(balls):
                    left = h[k]
                    for i in range(d * k, d * k + d):
                        left -= primal * step[i] * (2.0 * w[i] + primal * step[i])
                        trial[i] = step[i]
                    after += (y[k] + dual * dy[k]) * left
                    dy_trial[k] = dy[k]
                ratio = min(1.0, after / ((count + balls) * product))
                target = max(ratio * ratio * ratio, _RECENTERING if stuck else _LEAST_CENTERING) * product
        primal, dual = min(1.0, _SHARE * primal), min(1.0, _SHARE * dual)
        stuck = min(primal, dual) < _SHORT
        margin += primal * dm
        for j in range(count):
            z[j] += dual * dz[j]
        for i in range(size):
            w[i] += primal * step[i]
        _inner(w, w, d, squares)
        for k in range(balls):
            h[k] = 1.0 - squares[k]
            y[k] += dual * dy[k]
            if not (h[k] > 0.0 and y[k] > 0.0):
                return w, best, CLOSE if gap <= _USABLE * reach else SINGULAR, iteration
    return w, best, CLOSE if gap <= _USABLE * reach else SLOW, MOST_ITERATIONS
