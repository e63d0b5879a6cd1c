"""Maps are computed by blocks of rows: a map of a million cells would hold dozens of arrays of its size otherwise."""

from __future__ import annotations

from collections.abc import Iterator

MOST_CELLS = 32_768
"""Cells of a block; the arrays over one fit into the cache of a core."""


def row_blocks(rows: int, columns: int) -> Iterator[slice]:
    """Slices of ``rows`` rows in order, each of at most :data:`MOST_CELLS` cells or one row."""
    step = max(1, MOST_CELLS // columns)
    return (slice(begin, begin + step) for begin in range(0, rows, step))
