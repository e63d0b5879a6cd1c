"""The layout of nodes in the kernel's memory: reordered axes, ghost nodes on the last one, contiguous blocks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from safestart.levelset.lattice import Boundary, Lattice
from safestart.levelset.numbers import SLACK
from safestart.model.scenario import Floats

Array = NDArray[Any]

# A block and its row buffers should fit in the first caches; a longer row needs no second axis.
LONGEST_BLOCK, LONG_ROW = 4096, 256
ROWS_AT_ONCE = 4096


@dataclass(frozen=True, slots=True)
class Layout:
    """``order`` (internal axis -> axis of the lattice), ``outer`` axes outside a block, ``width`` ghost nodes."""

    lattice: Lattice
    order: tuple[int, ...]
    outer: int
    width: int

    @classmethod
    def of(cls, lattice: Lattice, width: int) -> Layout:
        """The longest axis last (ghosts cost least there), the shortest before it, the others in their order."""
        n, shape = lattice.ndim, lattice.shape
        last = max(range(n), key=lambda i: shape[i])
        others = [i for i in range(n) if i != last]
        beside = min(reversed(others), key=lambda i: shape[i])
        order = (*(i for i in others if i != beside), beside, last)
        pitch = shape[last] + 2 * width
        two = n > 2 and pitch <= LONG_ROW and pitch * shape[beside] <= LONGEST_BLOCK
        return cls(lattice, order, n - 2 if two else n - 1, width)

    @property
    def shape(self) -> tuple[int, ...]:
        """Node counts in internal order."""
        return tuple(self.lattice.shape[i] for i in self.order)

    @property
    def pitch(self) -> int:
        """Length of a row with its ghosts."""
        return self.shape[-1] + 2 * self.width

    @property
    def block(self) -> int:
        """Values of a block, ghosts included."""
        return math.prod(self.shape[self.outer : -1]) * self.pitch

    @property
    def blocks(self) -> int:
        """The number of blocks."""
        return math.prod(self.shape[: self.outer])

    @property
    def strides(self) -> NDArray[np.int64]:
        """Distance in memory to the next node along every internal axis."""
        padded = (*self.shape[:-1], self.pitch)
        return np.array([math.prod(padded[i + 1 :]) for i in range(len(padded))], dtype=np.int64)

    @property
    def boundary(self) -> tuple[Boundary, ...]:
        """Boundaries in internal order."""
        return tuple(self.lattice.boundary[i] for i in self.order)

    def empty(self, dtype: Any) -> Array:
        """Zeros for one value function."""
        return np.zeros(self.blocks * self.block + 2 * SLACK, dtype=dtype)

    def nodes(self, flat: Array) -> Array:
        """View of the nodes of a flat array, in the lattice's order of axes, without ghosts."""
        rows = flat[SLACK:-SLACK].reshape(*self.shape[:-1], self.pitch)
        inner = rows[..., self.width : self.pitch - self.width]
        return inner.transpose(np.argsort(self.order))

    def pack(self, values: Array, dtype: Any) -> Array:
        """Flat array of values that broadcast against the lattice, ghosts filled."""
        flat = self.empty(dtype)
        self.nodes(flat)[...] = values
        rows = flat[SLACK:-SLACK].reshape(-1, self.pitch)
        # In pieces: a padded copy of a large grid would be as large as the grid.
        for begin in range(0, len(rows), ROWS_AT_ONCE):
            some = rows[begin : begin + ROWS_AT_ONCE]
            some[...] = self.pad(some[:, self.width : self.pitch - self.width])
        return flat

    def pad(self, rows: Array) -> Array:
        """Rows (..., k) with their ghosts, (..., pitch)."""
        g, boundary = self.width, self.boundary[-1]
        around = [(0, 0)] * (rows.ndim - 1) + [(g, g)]
        if boundary is Boundary.PERIODIC:
            return np.pad(rows, around, "wrap")
        padded = np.pad(rows, around, "edge")
        if boundary is not Boundary.EDGE:
            depth = np.arange(1, g + 1)
            for first, second, ghosts in ((0, 1, slice(g - 1, None, -1)), (-1, -2, slice(-g, None))):
                slope = rows[..., first] - rows[..., second]
                if boundary is Boundary.AWAY_FROM_ZERO:
                    slope = np.sign(rows[..., first]) * np.abs(slope)
                padded[..., ghosts] = rows[..., first, None] + slope[..., None] * depth
        return padded

    def block_pad(self, values: Floats) -> Floats:
        """Arrays over (outer axes..., block axes...) as (outer axes..., block length); ghosts repeat the edge."""
        g = self.width
        padded = np.pad(values, [(0, 0)] * (values.ndim - 1) + [(g, g)], "edge")
        return padded.reshape(*values.shape[: self.outer], self.block)
