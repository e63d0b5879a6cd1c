"""Sums and triangular systems of small dense matrices, for compiled methods: the same bits on every processor."""

from __future__ import annotations

import math
from typing import Any

from safestart.runtime.kernels import compiled

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
def factor(matrix: Any) -> bool:
    """Cholesky factor into the lower triangle, in place; False where the matrix is not positive definite."""
    size = len(matrix)
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
