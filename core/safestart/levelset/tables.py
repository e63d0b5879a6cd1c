"""Arrays over the grid for the kernel: a scalar per block plus a run per block, without repetition.

A table is the sum of a part that is constant inside a block and a part that varies there. Each is stored only over
the axes it depends on; along the others its stride is 0. A linear model thus needs a few runs, not copies of the grid.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from safestart.levelset.layout import Layout
from safestart.model.scenario import Floats


@dataclass(frozen=True, slots=True)
class Tables:
    """``where`` (rows, 2 + 2 outer): start and outer strides of both parts; ``data`` flat values."""

    where: NDArray[np.int64]
    data: NDArray[Any]

    @classmethod
    def of(cls, layout: Layout, rows: Sequence[Sequence[Floats]], dtype: Any) -> Tables:
        """One table per row: the sum of its terms, arrays that broadcast against the lattice."""
        outer = layout.outer
        # The first run is zeros, for tables without a varying part.
        parts: list[NDArray[Any]] = [np.zeros(layout.block, dtype=dtype)]
        where = np.zeros((len(rows), 2 + 2 * outer), dtype=np.int64)
        free = layout.block
        for k, terms in enumerate(rows):
            flat, varying = _split(layout, terms)
            for column, part, run in ((0, flat, 1), (1, varying, layout.block)):
                if part is None:
                    continue
                where[k, column] = free
                stride = run
                for axis in range(outer - 1, -1, -1):
                    if part.shape[axis] > 1:
                        where[k, 2 + column * outer + axis] = stride
                        stride *= part.shape[axis]
                parts.append(part.ravel().astype(dtype))
                free += part.size
        return cls(where, np.concatenate(parts))


def _split(layout: Layout, terms: Sequence[Floats]) -> tuple[Floats | None, Floats | None]:
    """Sums of the terms that are constant in a block (outer axes), and of the others (outer axes, block length)."""
    constant: Floats | None = None
    varying: Floats | None = None
    for term in terms:
        inner = np.transpose(np.asarray(term, dtype=np.float64), layout.order)
        if all(size == 1 for size in inner.shape[layout.outer :]):
            part = inner.reshape(inner.shape[: layout.outer])
            constant = part if constant is None else constant + part
        else:
            varying = inner if varying is None else varying + inner
    if varying is None:
        return constant, None
    full = np.broadcast_to(varying, varying.shape[: layout.outer] + layout.shape[layout.outer :])
    return constant, layout.block_pad(full)
