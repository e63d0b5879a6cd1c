"""Compiled kernel: how fast the value can travel, for the longest stable step."""

from __future__ import annotations

from types import ModuleType

import numpy as np
from numba import njit

from safestart.levelset.kernels import jit_options as kernel
from safestart.levelset.kernels import table as table_kernel
from safestart.levelset.kernels.jit_options import FAST, Whole
from safestart.levelset.kernels.table import entry
from safestart.model.scenario import Floats
from safestart.runtime.stamp import source_stamp

SOURCES: tuple[ModuleType, ...] = (kernel, table_kernel)
"""Modules of what the kernel calls: their text is part of its cache key."""


def _build(stamp: int):  # type: ignore[no-untyped-def]
    @njit(cache=True, nogil=True, error_model="numpy", fastmath=FAST)
    def fastest(shape: Whole, plan: Whole, scale: Floats, where: Whole, data: Floats) -> float:
        """Largest sum over axes of (|f| + spread) / spacing on the nodes: 1 / (longest stable step)."""
        stamp  # noqa: B018  (the cell is part of numba's cache key)
        outer, length, axes = plan[0], plan[1], len(shape)
        size = np.uint64(length)
        sums = np.empty(length, data.dtype)
        index = np.zeros(outer, np.int64)
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

    return fastest


fastest = _build(source_stamp(*SOURCES))
