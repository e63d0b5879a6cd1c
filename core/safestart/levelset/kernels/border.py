"""Compiled part of the sweep: the neighbours of a run of nodes, ghosts beyond the ends of an axis included."""

from __future__ import annotations

import numpy as np

from safestart.levelset.kernels.jit_options import Indices, Word, inlined
from safestart.levelset.numbers import AWAY, EDGE, PERIODIC
from safestart.model.scenario import Floats


@inlined
def beyond(value: float, inner: float, depth: float, boundary: int) -> float:
    """Value ``depth`` nodes beyond the end of an axis, from the last one and its neighbour."""
    slope = value - inner
    if boundary == AWAY:
        slope = abs(slope)
        if value < 0.0:
            slope = -slope
        elif value == 0.0:
            slope = value
    return value + depth * slope


@inlined
def stencil(
    v: Floats,
    center: int,
    position: int,
    count: int,
    stride: int,
    boundary: int,
    width: int,
    spare: Floats,
    length: Word,
    at: Indices,
) -> bool:
    """Starts of the 2 ``width`` + 1 runs around one; True when they were copied to ``spare`` with ghosts."""
    inside = position >= width and position < count - width
    for q in range(2 * width + 1):
        row = position + q - width
        row = (row + count) % count if boundary == PERIODIC else min(max(row, 0), count - 1)
        at[q] = np.uint64(center + (row - position) * stride)
    if inside or boundary <= PERIODIC:
        return False
    size = np.uint64(length)
    for q in range(2 * width + 1):
        row = position + q - width
        to, start = np.uint64(q) * size, at[q]
        depth = max(-row, row - count + 1)
        at[q] = to
        if depth <= 0:
            for j in range(size):
                spare[to + j] = v[start + j]
        else:
            inner = np.uint64(center + ((1 if row < 0 else count - 2) - position) * stride)
            far = v.dtype.type(depth)
            for j in range(size):
                spare[to + j] = beyond(v[start + j], v[inner + j], far, boundary)
    return True


@inlined
def close(out: Floats, center: int, length: Word, pitch: int, width: int, boundary: int) -> None:
    """Fill the ghost nodes at both ends of every row of a block."""
    count = pitch - 2 * width
    for start in range(center, center + length, pitch):
        low, high = start + width, start + width + count - 1
        for depth in range(1, width + 1):
            if boundary == EDGE:
                out[low - depth], out[high + depth] = out[low], out[high]
            elif boundary == PERIODIC:
                out[low - depth], out[high + depth] = out[high + 1 - depth], out[low - 1 + depth]
            else:
                far = out.dtype.type(depth)
                out[low - depth] = beyond(out[low], out[low + 1], far, boundary)
                out[high + depth] = beyond(out[high], out[high - 1], far, boundary)
