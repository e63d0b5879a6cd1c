"""Euclidean projection of a point onto a polyhedron in the plane or in space, by a dual active-set method."""

from __future__ import annotations

import math

from safestart.runtime.kernels.compiled import compiled

FEASIBLE, INFEASIBLE, STALLED = 0, 1, 2

VIOLATION = 1e-9
"""A row counts as satisfied up to this distance, in units of the scaled command (multiples of a_max)."""

DEPENDENT = 1e-10
"""A unit normal this close to the span of the active ones counts as lying in it."""

MAX_STEPS = 200
"""Limit on steps: no test needs more than a few dozen; beyond it the caller falls back."""


@compiled(error_model="numpy")
def project(normals, bounds, point, work, active):  # type: ignore[no-untyped-def]
    """Move ``point`` (d,) to the nearest point with ``point @ normals <= bounds``; return a status code.

    ``normals`` (d, m) has columns of length 1, ``bounds`` (m,), d is 2 or 3; ``work`` (9, 4) and ``active`` (4,)
    integers are scratch. ``FEASIBLE``: done, to 1e-9. ``INFEASIBLE``: the polyhedron is empty. ``STALLED``: not
    finished; then ``point`` means nothing.

    Method: Goldfarb and Idnani's dual active set (Mathematical Programming 27, 1983) with the identity as Hessian.
    It starts from the point itself, adds the most violated row, and drops rows whose multiplier would turn
    negative. At most d rows are active, so their orthonormal basis is rebuilt (Gram-Schmidt, twice) each time.
    """
    d, m = normals.shape
    multiplier, step, ratio = work[0], work[1], work[2]
    basis, upper = work[3:6], work[6:9]
    count = 0
    entering = -1
    entering_multiplier = 0.0
    for _ in range(MAX_STEPS):
        if entering < 0:
            worst = VIOLATION
            for r in range(m):
                value = -bounds[r]
                for i in range(d):
                    value += normals[i, r] * point[i]
                if value > worst:
                    worst, entering = value, r
            if entering < 0:
                return FEASIBLE
            for q in range(count):
                # Violated although active: only rounding, so stop here.
                if active[q] == entering:
                    return FEASIBLE
            entering_multiplier = 0.0
        # step = the part of the entering normal orthogonal to the active ones; ratio = its coordinates among them.
        for i in range(d):
            step[i] = normals[i, entering]
        for q in range(count):
            ratio[q] = 0.0
        for _pass in range(2):
            for q in range(count):
                dot = 0.0
                for i in range(d):
                    dot += basis[q, i] * step[i]
                ratio[q] += dot
                for i in range(d):
                    step[i] -= dot * basis[q, i]
        for q in range(count - 1, -1, -1):
            for p in range(q + 1, count):
                ratio[q] -= upper[q, p] * ratio[p]
            ratio[q] /= upper[q, q]
        square = 0.0
        violation = -bounds[entering]
        for i in range(d):
            square += step[i] * step[i]
            violation += normals[i, entering] * point[i]
        leaving = -1
        dual_length = math.inf
        for q in range(count):
            if ratio[q] > 0.0 and multiplier[q] < dual_length * ratio[q]:
                dual_length, leaving = multiplier[q] / ratio[q], q
        primal_length = math.inf
        if count < d and square > DEPENDENT * DEPENDENT:
            primal_length = violation / square
        length = min(primal_length, dual_length)
        if length == math.inf:
            return INFEASIBLE
        if primal_length < math.inf:
            for i in range(d):
                point[i] -= length * step[i]
        for q in range(count):
            multiplier[q] -= length * ratio[q]
        entering_multiplier += length
        if primal_length <= dual_length:
            active[count] = entering
            multiplier[count] = entering_multiplier
            count += 1
            entering = -1
        else:
            count -= 1
            for q in range(leaving, count):
                active[q] = active[q + 1]
                multiplier[q] = multiplier[q + 1]
        # Orthonormal basis of the active normals: normals[:, active] = basis^T upper.
        for q in range(count):
            for i in range(d):
                basis[q, i] = normals[i, active[q]]
            for p in range(q):
                upper[p, q] = 0.0
            for _pass in range(2):
                for p in range(q):
                    dot = 0.0
                    for i in range(d):
                        dot += basis[p, i] * basis[q, i]
                    upper[p, q] += dot
                    for i in range(d):
                        basis[q, i] -= dot * basis[p, i]
            square = 0.0
            for i in range(d):
                square += basis[q, i] * basis[q, i]
            upper[q, q] = math.sqrt(square)
            for i in range(d):
                basis[q, i] /= upper[q, q]
    return STALLED
