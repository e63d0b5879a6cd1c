"""Quadratic programs of a dozen variables by a dual active-set method, compiled.

Minimise z' H z / 2 + g' z subject to low <= rows' z <= high. Goldfarb and Idnani (Mathematical Programming 27, 1983):
starting at the free minimum, the most violated row enters, and rows whose multiplier would turn negative leave. The
method ends with the minimum, or with a row whose normal is a nonpositive combination of the active ones: a proof of
infeasibility. Both sides of a row count as one row, and one pass over contiguous memory gives all values.
"""

from __future__ import annotations

import math

import numpy as np

from safestart.runtime.kernels.compiled import compiled

SOLVED, INFEASIBLE, STALLED = 0, 1, 2

VIOLATION = 1e-11
"""Rows count as satisfied up to this violation, in their own units."""
DEPENDENT = 1e-20
"""A normal counts as in the span of the active ones if less than this share of its squared length is outside."""


@compiled(error_model="numpy", fastmath={"contract", "reassoc", "nsz"})
def add_scaled(out, column, factor):  # type: ignore[no-untyped-def]
    """Out += factor * column."""
    for r in range(len(out)):
        out[r] += factor * column[r]


@compiled(error_model="numpy", fastmath={"contract", "reassoc", "nsz"})
def inner(left, right):  # type: ignore[no-untyped-def]
    """Left . right."""
    out = 0.0
    for i in range(len(left)):
        out += left[i] * right[i]
    return out


@compiled(error_model="numpy")
def inverse_factor(hessian, out):  # type: ignore[no-untyped-def]
    """Write L^-1 (n, n) of H = L L' into ``out``; False if H is not positive definite."""
    n = len(hessian)
    lower = np.zeros((n, n))
    for j in range(n):
        square = hessian[j, j] - inner(lower[j, :j], lower[j, :j])
        if not square > 0.0:
            return False
        lower[j, j] = math.sqrt(square)
        for i in range(j + 1, n):
            lower[i, j] = (hessian[i, j] - inner(lower[i, :j], lower[j, :j])) / lower[j, j]
    for i in range(n):
        out[i] = 0.0
        for k in range(i):
            add_scaled(out[i, : k + 1], out[k, : k + 1], -lower[i, k])
        out[i, i] += 1.0
        for j in range(i + 1):
            out[i, j] /= lower[i, i]
    return True


@compiled(error_model="numpy")
def rotate(first, second, cosine, sine):  # type: ignore[no-untyped-def]
    """A plane rotation of two vectors in place."""
    for i in range(len(first)):
        one, two = first[i], second[i]
        first[i] = cosine * one + sine * two
        second[i] = cosine * two - sine * one


@compiled(error_model="numpy")
def minimise(factor, gradient, rows, low, high, z, dual):  # type: ignore[no-untyped-def]
    """Solve; returns (status, steps).

    ``factor`` (n, n) is L^-1, H = L L', and is overwritten; ``gradient`` (n,), ``rows`` (n, R), ``low`` and ``high``
    (R,), infinite where there is no bound. ``z`` (n,) becomes the minimum. ``dual`` (R,) becomes the multipliers,
    positive at ``high``, negative at ``low``: H z + g + rows dual = 0. With the status INFEASIBLE it is a proof:
    rows dual = 0 and sum of max(dual, 0) high + min(dual, 0) low < 0.
    """
    n, count = rows.shape
    upper, d, ratio, step = np.zeros((n, n)), np.empty(n), np.empty(n), np.empty(n)
    active, sides, multipliers = np.empty(n, np.int64), np.empty(n), np.empty(n)
    values = np.zeros(count)
    dual[:] = 0.0
    z[:] = 0.0
    for k in range(n):
        add_scaled(z, factor[k], -inner(factor[k], gradient))
    for i in range(n):
        add_scaled(values, rows[i], z[i])
    size, steps, limit = 0, 0, 100 + 20 * n
    while True:
        worst, entering, side = VIOLATION, -1, 1.0
        for r in range(count):
            above, below = values[r] - high[r], low[r] - values[r]
            if above > worst:
                worst, entering, side = above, r, 1.0
            if below > worst:
                worst, entering, side = below, r, -1.0
        if entering < 0:
            for q in range(size):
                dual[active[q]] = sides[q] * multipliers[q]
            return SOLVED, steps
        multiplier, whole = 0.0, 0.0
        for k in range(n):
            d[k] = 0.0
            for i in range(n):
                d[k] += factor[k, i] * rows[i, entering]
            d[k] *= side
            whole += d[k] * d[k]
        while True:
            steps += 1
            if steps > limit:
                return STALLED, steps
            outside = inner(d[size:], d[size:])
            for q in range(size - 1, -1, -1):
                ratio[q] = (d[q] - inner(upper[q, q + 1 : size], ratio[q + 1 : size])) / upper[q, q]
            length, leaving = np.inf, -1
            for q in range(size):
                if ratio[q] > 0.0 and multipliers[q] < length * ratio[q]:
                    length, leaving = multipliers[q] / ratio[q], q
            full = size < n and outside > DEPENDENT * whole
            if not full and leaving < 0:
                dual[entering] = side
                for q in range(size):
                    dual[active[q]] = -sides[q] * ratio[q]
                return INFEASIBLE, steps
            if full and worst <= length * outside:
                length, leaving = worst / outside, -1
            if full:
                step[:] = 0.0
                for k in range(size, n):
                    add_scaled(step, factor[k], -d[k])
                for i in range(n):
                    z[i] += length * step[i]
                    add_scaled(values, rows[i], length * step[i])
                worst -= length * outside
            for q in range(size):
                multipliers[q] -= length * ratio[q]
            multiplier += length
            if leaving < 0:
                break
            size -= 1
            for q in range(leaving, size):
                active[q], sides[q], multipliers[q] = active[q + 1], sides[q + 1], multipliers[q + 1]
                for k in range(q + 2):
                    upper[k, q] = upper[k, q + 1]
            for q in range(leaving, size):
                long = math.hypot(upper[q, q], upper[q + 1, q])
                cosine, sine = upper[q, q] / long, upper[q + 1, q] / long
                rotate(upper[q, q:size], upper[q + 1, q:size], cosine, sine)
                upper[q + 1, q] = 0.0
                rotate(factor[q], factor[q + 1], cosine, sine)
                d[q], d[q + 1] = cosine * d[q] + sine * d[q + 1], cosine * d[q + 1] - sine * d[q]
        for k in range(n - 1, size, -1):
            if d[k] == 0.0:
                continue
            long = math.hypot(d[k - 1], d[k])
            cosine, sine = d[k - 1] / long, d[k] / long
            d[k - 1] = long
            rotate(factor[k - 1], factor[k], cosine, sine)
        for k in range(size + 1):
            upper[k, size] = d[k]
        active[size], sides[size], multipliers[size] = entering, side, multiplier
        size += 1
