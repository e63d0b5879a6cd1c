"""Compiled kernel: how fast the value can travel, for the longest stable step."""

from __future__ import annotations

import numpy as np

from safestart.levelset.kernels.jit_options import FAST, Whole
from safestart.levelset.kernels.table import entry
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled


@compiled(error_model="numpy", fastmath=FAST)
def fastest(shape: Whole, plan: Whole, scale: Floats, where: Whole, data: Floats) -> float:
    """Largest sum over axes of (|f| + spread) / spacing on the nodes: 1 / (longest stable step)."""
    outer, length, axes = plan[0], plan[1], len(shape)
    size = np.uint64(length)
    sums = np.empty(length, data.dtype)
    index = np.empty(outer, np.int64)
    most = data.dtype.type(0.0)
    blocks = 1
    for k in range(outer):
        blocks *= shape[k]
    for block in range(blocks):
        rest = block
        for k in range(outer - 1, -1, -1):
            index[k] = rest % shape[k]
            rest //= shape[k]
        for axis in range(axes):
            rate, rates = entry(where, axis, index, data)
            spread, spreads = entry(where, axes + axis, index, data)
            factor = scale[axis]
            for j in range(size):
                step = (abs(rate + data[rates + j]) + spread + data[spreads + j]) * factor
                sums[j] = sums[j] + step if axis > 0 else step
        for j in range(size):
            most = max(most, sums[j])
    return most
