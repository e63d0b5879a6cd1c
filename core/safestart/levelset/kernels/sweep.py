"""Compiled kernel: one stage of a level-set step, V <- a V0 + b (V + dt H(x, grad V)), over a range of blocks.

Derivatives, numerical Hamiltonian and update are fused: plain loops, which the compiler vectorises, process a block
(the last one or two axes, contiguous) in row buffers that stay in the first cache. The number of axes, inputs and the
scheme are data, so that each precision needs one compilation.

Memory (see :mod:`safestart.levelset.layout`): ``v`` is flat, blocks follow each other after ``SLACK`` values; inside a
block the last axis has ``width`` ghost nodes at either end, filled here when a block is done. Stencils along the other
axes are the same run of nodes, displaced.

Index arithmetic inside loops is uint64: a signed index is checked for wrap-around, which stops vectorisation.
The other files of this folder hold its parts.
"""

from __future__ import annotations

import numpy as np

from safestart.levelset.kernels.border import close, stencil
from safestart.levelset.kernels.derivative import derivatives
from safestart.levelset.kernels.hamiltonian import add_inputs, blend, first_blend, godunov
from safestart.levelset.kernels.jit_options import FAST, Whole
from safestart.levelset.kernels.table import entry
from safestart.levelset.numbers import ALWAYS, FIRST, GODUNOV, LAX_FRIEDRICHS, SLACK, TUBE
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled


@compiled(error_model="numpy", fastmath=FAST)
def sweep(
    v: Floats,
    first: Floats,
    out: Floats,
    weights: Floats,
    shape: Whole,
    strides: Whole,
    plan: Whole,
    boundary: Whole,
    scale: Floats,
    where: Whole,
    data: Floats,
    groups: Whole,
    channels: Whole,
    entries: Whole,
    bounds: Floats,
    clamp_where: Whole,
    clamp: Floats,
    begin: int,
    end: int,
) -> None:
    """Blocks [begin, end) of one stage: out <- a first + b (v + dt H), then cut off between floor and cap.

    ``weights`` (a, b, dt); ``plan`` (outer axes, block length, pitch, ghosts, scheme, flux, set, clamps: 1 cap,
    2 floor, 3 both); ``shape``, ``strides`` (in ``v``), ``boundary`` and ``scale`` (1 / spacing) by axis;
    ``where`` and ``data`` the tables of :mod:`safestart.levelset.tables` (drift, spread and kink of each axis,
    then the gains). ``out`` may be ``first``, not ``v``.
    """
    outer, length, pitch, width = plan[0], plan[1], plan[2], plan[3]
    scheme, flux, kind, clamps = plan[4], plan[5], plan[6], plan[7]
    axes = len(shape)
    size, ends = np.uint64(length), length // pitch
    real = v.dtype.type
    a, b, dt = weights[0], weights[1], weights[2]
    zero = real(0.0)
    least, most = real(-np.inf), real(np.inf)
    if kind == TUBE:
        most = zero
    elif kind == ALWAYS:
        least = zero
    total, left, right = np.empty(length, v.dtype), np.empty(length, v.dtype), np.empty(length, v.dtype)
    share, norm = np.empty(length, v.dtype), np.empty(length, v.dtype)
    mean = np.empty(axes * length, v.dtype)
    spare = np.empty((2 * width + 1) * length, v.dtype)
    at = np.empty(7, np.uint64)
    index, moved = np.empty(outer, np.int64), np.empty(axes, np.int64)
    fused = scheme == FIRST and flux == LAX_FRIEDRICHS
    # Axes that an input moves; the others need no mean slope.
    for axis in range(axes):
        moved[axis] = 0
    for axis in entries:
        moved[axis] = 1
    for block in range(begin, end):
        rest = block
        for k in range(outer - 1, -1, -1):
            index[k] = rest % shape[k]
            rest //= shape[k]
        center = SLACK + block * length
        for j in range(size):
            total[j] = zero
        for axis in range(axes):
            # Along outer axes a block is one run; along its second axis each row near an end is a run of its own.
            across = axis < axes - 1
            inner = axis >= outer and across
            count, stride = (ends, pitch) if inner else (shape[axis], strides[axis])
            rate, rates = entry(where, axis, index, data)
            kink, kinks = entry(where, (2 * axes if flux == GODUNOV else axes) + axis, index, data)
            to = np.uint64(axis * length)
            row = 0
            while row < ends:
                rows = ends
                if inner:
                    rows = ends - 2 * width if row >= width and row < ends - width else 1
                run = rows * pitch
                copied = False
                if across:
                    place = row if inner else index[axis]
                    copied = stencil(
                        v,
                        center + row * pitch,
                        place,
                        count,
                        stride,
                        boundary[axis],
                        width,
                        spare,
                        run,
                        at,
                    )
                else:
                    for q in range(2 * width + 1):
                        at[q] = np.uint64(center + q - width)
                source = spare if copied else v
                if fused:
                    first_blend(
                        source, at, scale[axis], rate, kink, data, rates, kinks, total, mean,
                        np.uint64(row * pitch), to, np.uint64(run), moved[axis] == 1,
                    )  # fmt: skip
                else:
                    part, span = np.uint64(row * pitch), np.uint64(run)
                    derivatives(scheme, source, at, scale[axis], left, right, part, span)
                row += rows
            if flux == GODUNOV:
                godunov(left, right, rate, kink, data, rates, kinks, total, size)
            elif not fused:
                blend(left, right, rate, kink, data, rates, kinks, total, mean, to, size, moved[axis] == 1)
        if flux == LAX_FRIEDRICHS:
            add_inputs(
                groups,
                channels,
                entries,
                bounds,
                where,
                data,
                axes,
                index,
                mean,
                share,
                norm,
                total,
                length,
            )
        start = np.uint64(center)
        # This order of the comparisons keeps NaN, which must stay visible.
        if a == zero:
            for j in range(size):
                rise = most if total[j] > most else total[j]
                rise = least if rise < least else rise
                out[start + j] = v[start + j] + dt * rise
        else:
            for j in range(size):
                rise = most if total[j] > most else total[j]
                rise = least if rise < least else rise
                out[start + j] = a * first[start + j] + b * (v[start + j] + dt * rise)
        if clamps & 1:
            level, levels = entry(clamp_where, 0, index, clamp)
            for j in range(size):
                bound = level + clamp[levels + j]
                out[start + j] = bound if out[start + j] > bound else out[start + j]
        if clamps & 2:
            level, levels = entry(clamp_where, 1, index, clamp)
            for j in range(size):
                bound = level + clamp[levels + j]
                out[start + j] = bound if out[start + j] < bound else out[start + j]
        close(out, center, length, pitch, width, boundary[axes - 1])
