"""The constraints of a step's program and their transpose, and Cholesky's factors, for ``hop_solver``; compiled."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

Flags = NDArray[np.bool_]


@compiled()
def factored(m: Floats) -> bool:
    """Cholesky factor of ``m`` (N, N), in its lower triangle; False if it is not positive definite."""
    size = len(m)
    for j in range(size):
        pivot = m[j, j]
        for k in range(j):
            pivot -= m[j, k] * m[j, k]
        if not pivot > 0.0:
            return False
        root = math.sqrt(pivot)
        m[j, j] = root
        for i in range(j + 1, size):
            total = m[i, j]
            for k in range(j):
                total -= m[i, k] * m[j, k]
            m[i, j] = total / root
    return True


@compiled()
def substituted(m: Floats, x: Floats) -> None:
    """Solve with the factor, in place."""
    size = len(m)
    for i in range(size):
        for k in range(i):
            x[i] -= m[i, k] * x[k]
        x[i] /= m[i, i]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            x[i] -= m[k, i] * x[k]
        x[i] /= m[i, i]


@compiled()
def linear_parts(
    u: Floats,
    p: Floats,
    m: Floats,
    s: Floats,
    t: float,
    a: Floats,
    both: Flags,
    g: Floats,
    boxed: bool,
    out: Floats,
) -> None:
    """The linear parts of all constraints, in order: p, m, s, s + A u, s - A u, t, t + G u_0, the box of u_0."""
    c, r, b = len(u), len(s), len(g)
    for i in range(c):
        out[i], out[c + i] = p[i], m[i]
    at = 2 * c
    for i in range(r):
        value = 0.0
        for j in range(c):
            value += a[i, j] * u[j]
        out[at + i] = s[i]
        out[at + r + i] = s[i] + value
        out[at + 2 * r + i] = s[i] - value if both[i] else 0.0
    at += 3 * r
    out[at] = t
    for i in range(b):
        out[at + 1 + i] = t + g[i, 0] * u[0] + g[i, 1] * u[1] + g[i, 2] * u[2]
    at += 1 + b
    for i in range(3):
        out[at + i] = -u[i] if boxed else 0.0
        out[at + 3 + i] = u[i] if boxed else 0.0


@compiled()
def pulled_back(c: int, a: Floats, both: Flags, g: Floats, boxed: bool, y: Floats, out: Floats) -> float:
    """(A' (y4 - y5) + G' y7 + box)(c,) of vectors over the constraints; returns the sum over t and the barrier."""
    r, b = len(a), len(g)
    out[:] = 0.0
    at = 2 * c + r
    for i in range(r):
        v = y[at + i] - (y[at + r + i] if both[i] else 0.0)
        for j in range(c):
            out[j] += v * a[i, j]
    at += 2 * r
    total: float = y[at]
    for i in range(b):
        v = y[at + 1 + i]
        total += v
        for j in range(3):
            out[j] += v * g[i, j]
    at += 1 + b
    if boxed:
        for j in range(3):
            out[j] += y[at + 3 + j] - y[at + j]
    return total
