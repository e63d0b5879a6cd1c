"""Compiled kernel: value and gradient of a grid function between its nodes."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

Whole = NDArray[np.int64]


@compiled(error_model="numpy")
def lookup(
    values: Floats, shape: Whole, low: Floats, spacing: Floats, periodic: Whole, states: Floats, out: Floats
) -> None:
    """``out`` (P, 1 + n): multilinear value, and multilinear mean of the corners' central differences.

    ``values`` is the flattened grid function. At the ends of an axis that is not periodic the difference is
    one-sided. ``states`` (P, n) must lie in the box.
    """
    n = len(shape)
    strides, cell, node = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n, np.int64)
    share = np.empty(n)
    strides[n - 1] = 1
    for i in range(n - 2, -1, -1):
        strides[i] = strides[i + 1] * shape[i + 1]
    for p in range(len(states)):
        for i in range(n):
            position = (states[p, i] - low[i]) / spacing[i]
            whole = math.floor(position)
            if periodic[i] == 0:
                whole = min(max(whole, 0), shape[i] - 2)
            cell[i], share[i] = whole, position - whole
        for k in range(n + 1):
            out[p, k] = 0.0
        for corner in range(1 << n):
            weight, flat = 1.0, 0
            for i in range(n):
                upper = corner >> i & 1
                weight *= share[i] if upper == 1 else 1.0 - share[i]
                node[i] = (cell[i] + upper) % shape[i]
                flat += node[i] * strides[i]
            if weight == 0.0:
                continue
            out[p, 0] += weight * values[flat]
            for i in range(n):
                before, after, steps = node[i] - 1, node[i] + 1, 2.0
                if periodic[i] == 1:
                    before, after = before % shape[i], after % shape[i]
                else:
                    if before < 0:
                        before, steps = 0, 1.0
                    if after == shape[i]:
                        after, steps = node[i], 1.0
                rise = (
                    values[flat + (after - node[i]) * strides[i]]
                    - values[flat + (before - node[i]) * strides[i]]
                )
                out[p, 1 + i] += weight * rise / (steps * spacing[i])
