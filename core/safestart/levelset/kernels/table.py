"""Compiled part of the sweep: read a table of :mod:`safestart.levelset.tables`."""

from __future__ import annotations

import numpy as np

from safestart.levelset.kernels.jit_options import Whole, Word, inlined
from safestart.model.scenario import Floats


@inlined
def entry(where: Whole, row: int, index: Whole, data: Floats) -> tuple[float, Word]:
    """Scalar part of a table for one block, and the start of its array part."""
    outer = len(index)
    scalar, start = where[row, 0], where[row, 1]
    for k in range(outer):
        scalar += where[row, 2 + k] * index[k]
        start += where[row, 2 + outer + k] * index[k]
    return data[scalar], np.uint64(start)
