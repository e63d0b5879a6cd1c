"""The command in the thrust box that violates the position rows least: a Chebyshev problem by the dual simplex."""

from __future__ import annotations

import math

from safestart.runtime.kernels.compiled import compiled

MAX_PIVOTS = 200
BLAND_AFTER = 60
TOLERANCE = 1e-11


@compiled(error_model="numpy")
def least_violation(normals, bounds, weights, point, work, basis):  # type: ignore[no-untyped-def]
    """Set ``point`` (d,) to a minimiser over the box |w_i| <= 1 of max_r weights_r (normals_r w - bounds_r).

    ``normals`` (d, m), ``bounds`` (m,), ``weights`` (m,) turn a row's violation into metres; rows of weight 0 are left
    out, at least one weight must be positive. ``work`` (9, 4) and ``basis`` (4,) integers are scratch. Returns the
    minimum in metres (negative when every row can be met strictly), or infinity when the pivots run out.

    Method: with y = (w, tau) the problem is min tau subject to weights_r normals_r w - tau <= weights_r bounds_r and
    the box. Any row with the box corner that opposes it is a dual feasible vertex; from there each pivot adds the
    most violated row and drops the one whose multiplier reaches zero first. d + 1 rows meet in a vertex, so the
    inverse of the basis is carried as a (d + 1) x (d + 1) array.
    """
    d, m = normals.shape
    inverse = work[:4]
    inverse[:] = 0.0
    row, coordinate, y = work[4], work[5], work[6]
    first = -1
    worst = -math.inf
    for r in range(m):
        if weights[r] > 0.0:
            value = -bounds[r]
            for i in range(d):
                value += normals[i, r] * point[i]
            if weights[r] * value > worst:
                worst, first = weights[r] * value, r
    # The corner of the box that opposes the first row; box rows are numbered m + 2 i (upper), m + 2 i + 1 (lower).
    y[d] = -weights[first] * bounds[first]
    inverse[d, d] = -1.0
    basis[d] = first
    for i in range(d):
        sign = -1.0 if normals[i, first] > 0.0 else 1.0
        y[i] = sign
        y[d] += sign * weights[first] * normals[i, first]
        inverse[i, i] = sign
        inverse[d, i] = sign * weights[first] * normals[i, first]
        basis[i] = m + 2 * i + (1 if sign < 0.0 else 0)
    for pivot in range(MAX_PIVOTS):
        entering = -1
        worst = TOLERANCE * (1.0 + abs(y[d]))
        for r in range(m):
            if entering >= 0 and pivot >= BLAND_AFTER:
                break
            if weights[r] > 0.0:
                value = -bounds[r]
                for i in range(d):
                    value += normals[i, r] * y[i]
                value = weights[r] * value - y[d]
                if value > worst:
                    entering, worst = r, value
        for i in range(d):
            value = abs(y[i]) - 1.0
            if value > worst and (entering < 0 or pivot < BLAND_AFTER):
                entering, worst = m + 2 * i + (0 if y[i] > 0.0 else 1), value
        if entering < 0:
            for i in range(d):
                point[i] = min(1.0, max(-1.0, y[i]))
            return y[d]
        for i in range(d + 1):
            row[i] = 0.0
        if entering < m:
            for i in range(d):
                row[i] = weights[entering] * normals[i, entering]
            row[d] = -1.0
        else:
            row[(entering - m) // 2] = 1.0 if (entering - m) % 2 == 0 else -1.0
        # Ratio test on the multipliers -inverse[d, :]; among ties the largest pivot. After many pivots Bland's rule
        # (lowest index, entering and leaving), which cannot cycle.
        leaving = -1
        best = math.inf
        for q in range(d + 1):
            coordinate[q] = 0.0
            for i in range(d + 1):
                coordinate[q] += row[i] * inverse[i, q]
        for q in range(d + 1):
            if coordinate[q] > 1e-12:
                value = max(0.0, -inverse[d, q]) / coordinate[q]
                better = value < best - 1e-14
                if not better and value <= best + 1e-14:
                    bland = pivot >= BLAND_AFTER
                    better = basis[q] < basis[leaving] if bland else coordinate[q] > coordinate[leaving]
                if better:
                    best, leaving = value, q
        if leaving < 0:
            return math.inf
        for i in range(d + 1):
            inverse[i, leaving] /= coordinate[leaving]
            y[i] -= worst * inverse[i, leaving]
        for q in range(d + 1):
            if q != leaving:
                for i in range(d + 1):
                    inverse[i, q] -= coordinate[q] * inverse[i, leaving]
        basis[leaving] = entering
    return math.inf
