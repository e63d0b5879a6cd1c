"""Sums and triangular systems of small dense matrices, for compiled methods: the same bits on every processor."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safestart.runtime.kernels.compiled import compiled

MANY = 64
"""Systems of more rows than this are put together and factored by the ways for large ones."""
_LEAST_PIVOT = 1e-15
"""A pivot is taken no smaller than this share of its diagonal entry."""


# Inlined: a call with two rows counts references to them, which takes longer than the sum.
@compiled(error_model="numpy", forceinline=True)
def dot(a: Any, b: Any, count: int) -> float:
    """a . b over the first ``count`` entries."""
    # Eight sums side by side: vector instructions without the freedom to reorder, so every processor gives these bits.
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = 0.0
    for eight in range(count // 8):
        i = 8 * eight
        s0 += a[i] * b[i]
        s1 += a[i + 1] * b[i + 1]
        s2 += a[i + 2] * b[i + 2]
        s3 += a[i + 3] * b[i + 3]
        s4 += a[i + 4] * b[i + 4]
        s5 += a[i + 5] * b[i + 5]
        s6 += a[i + 6] * b[i + 6]
        s7 += a[i + 7] * b[i + 7]
    total = ((s0 + s1) + (s2 + s3)) + ((s4 + s5) + (s6 + s7))
    for i in range(count - count % 8, count):
        total += a[i] * b[i]
    return total


@compiled(error_model="numpy")
def gram(rows: Any, ends: Any, turned: Any, system: Any) -> None:
    """rows rows^T into the lower triangle of ``system``, for many rows; row j is 0 from ``ends[j]`` on.

    ``turned`` (I, J) is room for the transpose. Two rows meet all others at once, four entries at a time: a vector
    holds entries of one column, each with a sum of its own, and is read and written once for eight products.
    """
    count = len(rows)
    spare = np.empty(count)
    for j in range(count):
        for i in range(rows.shape[1]):
            turned[i, j] = rows[j, i]
    for j in range(0, count, 2):
        other = min(j + 1, count - 1)
        one, two = system[j], system[other] if other > j else spare
        for i in range(other + 1):
            one[i] = two[i] = 0.0
        end = max(ends[j], ends[other])
        for four in range(end // 4):
            k = 4 * four
            a0, a1, a2, a3 = rows[j, k], rows[j, k + 1], rows[j, k + 2], rows[j, k + 3]
            b0, b1, b2, b3 = rows[other, k], rows[other, k + 1], rows[other, k + 2], rows[other, k + 3]
            c0, c1, c2, c3 = turned[k], turned[k + 1], turned[k + 2], turned[k + 3]
            for i in range(other + 1):
                v0, v1, v2, v3 = c0[i], c1[i], c2[i], c3[i]
                one[i] = (((one[i] + a0 * v0) + a1 * v1) + a2 * v2) + a3 * v3
                two[i] = (((two[i] + b0 * v0) + b1 * v1) + b2 * v2) + b3 * v3
        for k in range(end - end % 4, end):
            a, b = rows[j, k], rows[other, k]
            for i in range(other + 1):
                one[i] += a * turned[k, i]
                two[i] += b * turned[k, i]


@compiled(error_model="numpy")
def _factor_many(matrix: Any) -> bool:
    """The same by sums of eight, which are other bits and half the time."""
    for j in range(len(matrix)):
        row = matrix[j]
        pivot = max(row[j] - dot(row, row, j), _LEAST_PIVOT * row[j])
        if not 0.0 < pivot < math.inf:
            return False
        row[j] = math.sqrt(pivot)
        for below in range(j + 1, len(matrix)):
            matrix[below, j] = (matrix[below, j] - dot(matrix[below], row, j)) / row[j]
    return True


@compiled(error_model="numpy")
def factor(matrix: Any) -> bool:
    """Cholesky factor into the lower triangle, in place; False where the matrix is not positive definite."""
    size = len(matrix)
    if size > MANY:
        settled: bool = _factor_many(matrix)
        return settled
    for j in range(size):
        pivot, least = matrix[j, j], _LEAST_PIVOT * matrix[j, j]
        for i in range(j):
            pivot -= matrix[j, i] * matrix[j, i]
        pivot = max(pivot, least)
        if not 0.0 < pivot < math.inf:
            return False
        pivot = math.sqrt(pivot)
        matrix[j, j] = pivot
        for row in range(j + 1, size):
            value = matrix[row, j]
            for i in range(j):
                value -= matrix[row, i] * matrix[j, i]
            matrix[row, j] = value / pivot
    return True


@compiled(error_model="numpy")
def back(factor: Any, x: Any) -> None:
    """Solve with the factor, in place."""
    size = len(x)
    for j in range(size):
        value = x[j]
        for i in range(j):
            value -= factor[j, i] * x[i]
        x[j] = value / factor[j, j]
    for j in range(size - 1, -1, -1):
        value = x[j]
        for i in range(j + 1, size):
            value -= factor[i, j] * x[i]
        x[j] = value / factor[j, j]
