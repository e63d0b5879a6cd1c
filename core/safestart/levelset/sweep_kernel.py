"""Compiled kernel: one stage of a level-set step, V <- a V0 + b (V + dt H(x, grad V)), over a range of blocks.

Derivatives, numerical Hamiltonian and update are fused: a block (the last one or two axes, kept contiguous) is
worked through in row buffers that stay in the first cache, by plain loops that the compiler turns into vector code.
The number of axes, inputs and the scheme are data, so that there is one compilation per precision. All of it lives
in one file because Numba's cache sees changes in a kernel's own file only.

Memory (see :mod:`safestart.levelset.layout`): ``v`` is flat, blocks follow each other after ``SLACK`` values; inside a
block the last axis has ``width`` ghost nodes at either end, filled here when a block is done. Stencils along the other
axes are the same run of nodes, displaced.

Index arithmetic inside loops is uint64: a signed index is checked for wrap-around, which stops vectorisation. What is
called for every block is inlined: passing a dozen arrays costs as much as their work.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from safestart.scenario import Floats

Indices = NDArray[np.uint64]
Whole = NDArray[np.int64]
Word = Any
"""An index: uint64 where it is used in a loop."""

SLACK = 8
EDGE, PERIODIC, EXTRAPOLATE, AWAY = 0, 1, 2, 3
FIXED, TUBE, ALWAYS = 0, 1, 2
LAX_FRIEDRICHS, GODUNOV = 0, 1

# Fused multiply-add, and -0 as good as 0; nothing that lets NaN be assumed away.
_FAST = {"contract", "nsz"}


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _first_order(
    src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Differences to either neighbour, three runs."""
    a, b, c = at[0], at[1], at[2]
    for j in range(length):
        left[to + j] = (src[b + j] - src[a + j]) * scale
        right[to + j] = (src[c + j] - src[b + j]) * scale


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _eno2(
    src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Second-order essentially non-oscillatory (Osher and Shu 1991), five runs; ties take the left stencil."""
    half = src.dtype.type(0.5)
    a, b, c, d, e = at[0], at[1], at[2], at[3], at[4]
    for j in range(length):
        d0, d1 = (src[b + j] - src[a + j]) * scale, (src[c + j] - src[b + j]) * scale
        d2, d3 = (src[d + j] - src[c + j]) * scale, (src[e + j] - src[d + j]) * scale
        e0, e1, e2 = d1 - d0, d2 - d1, d3 - d2
        left[to + j] = d1 + half * (e1 if abs(e1) < abs(e0) else e0)
        right[to + j] = d2 - half * (e2 if abs(e2) < abs(e1) else e1)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _weno3(
    src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Third-order weighted ENO, five runs; the weights 1/3, 2/3 over (E^2 + eps)^2 on one denominator."""
    real = src.dtype.type
    half, two, eps = real(0.5), real(2.0), real(1e-6)
    a, b, c, d, e = at[0], at[1], at[2], at[3], at[4]
    for j in range(length):
        d0, d1 = (src[b + j] - src[a + j]) * scale, (src[c + j] - src[b + j]) * scale
        d2, d3 = (src[d + j] - src[c + j]) * scale, (src[e + j] - src[d + j]) * scale
        e0, e1, e2 = d1 - d0, d2 - d1, d3 - d2
        s0, s1, s2 = e0 * e0 + eps, e1 * e1 + eps, e2 * e2 + eps
        # Weights 1/s0^2 : 2/s1^2 (left) and 2/s1^2 : 1/s2^2 (right), times both squares.
        w0, w1, w2 = two * s0 * s0, s1 * s1, two * s2 * s2
        left[to + j] = d1 + half * (w1 * e0 + w0 * e1) / (w1 + w0)
        right[to + j] = d2 - half * (w2 * e1 + w1 * e2) / (w2 + w1)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _eno3(
    src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Third-order essentially non-oscillatory, seven runs."""
    real = src.dtype.type
    third, five, six, seven, eleven = (
        real(1.0 / 3.0),
        real(5.0 / 6.0),
        real(1.0 / 6.0),
        real(7.0 / 6.0),
        real(11.0 / 6.0),
    )
    a, b, c, d, e, f, g = at[0], at[1], at[2], at[3], at[4], at[5], at[6]
    for j in range(length):
        d0, d1 = (src[b + j] - src[a + j]) * scale, (src[c + j] - src[b + j]) * scale
        d2, d3 = (src[d + j] - src[c + j]) * scale, (src[e + j] - src[d + j]) * scale
        d4, d5 = (src[f + j] - src[e + j]) * scale, (src[g + j] - src[f + j]) * scale
        e0, e1, e2, e3, e4 = d1 - d0, d2 - d1, d3 - d2, d4 - d3, d5 - d4
        f0, f1, f2, f3 = abs(e1 - e0), abs(e2 - e1), abs(e3 - e2), abs(e4 - e3)
        q0 = third * d0 - seven * d1 + eleven * d2
        q1 = five * d2 - six * d1 + third * d3
        q2 = third * d2 + five * d3 - six * d4
        q3 = eleven * d3 - seven * d4 + third * d5
        middle_low = q2 if f2 < f1 else q1
        left[to + j] = middle_low if abs(e2) < abs(e1) else (q1 if f1 < f0 else q0)
        right[to + j] = (q3 if f3 < f2 else q2) if abs(e3) < abs(e2) else middle_low


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _weno5(
    src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Fifth-order weighted ENO (Jiang and Peng 2000), seven runs; one division per side."""
    real = src.dtype.type
    third, five, six, seven, eleven = (
        real(1.0 / 3.0),
        real(5.0 / 6.0),
        real(1.0 / 6.0),
        real(7.0 / 6.0),
        real(11.0 / 6.0),
    )
    k4, k5, k10, k11 = real(4.0 / 3.0), real(5.0 / 3.0), real(10.0 / 3.0), real(11.0 / 3.0)
    eps, sixfold, threefold = real(1e-6), real(6.0), real(3.0)
    a, b, c, d, e, f, g = at[0], at[1], at[2], at[3], at[4], at[5], at[6]
    for j in range(length):
        d0, d1 = (src[b + j] - src[a + j]) * scale, (src[c + j] - src[b + j]) * scale
        d2, d3 = (src[d + j] - src[c + j]) * scale, (src[e + j] - src[d + j]) * scale
        d4, d5 = (src[f + j] - src[e + j]) * scale, (src[g + j] - src[f + j]) * scale
        e0, e1, e2, e3, e4 = d1 - d0, d2 - d1, d3 - d2, d4 - d3, d5 - d4
        q0 = third * d0 - seven * d1 + eleven * d2
        q1 = five * d2 - six * d1 + third * d3
        q2 = third * d2 + five * d3 - six * d4
        q3 = eleven * d3 - seven * d4 + third * d5
        s0 = e0 * (k4 * e0 - k11 * e1) + k10 * e1 * e1 + eps
        s1 = e1 * (k4 * e1 - k5 * e2) + k4 * e2 * e2 + eps
        s2 = e2 * (k10 * e2 - k11 * e3) + k4 * e3 * e3 + eps
        t0 = e1 * (k4 * e1 - k11 * e2) + k10 * e2 * e2 + eps
        t1 = e2 * (k4 * e2 - k5 * e3) + k4 * e3 * e3 + eps
        t2 = e3 * (k10 * e3 - k11 * e4) + k4 * e4 * e4 + eps
        # Weights 1/s0^2 : 6/s1^2 : 3/s2^2 (left) and 3/t0^2 : 6/t1^2 : 1/t2^2 (right), times all the squares.
        u0, u1, u2 = s1 * s2, s0 * s2, s0 * s1
        w0, w1, w2 = u0 * u0, sixfold * u1 * u1, threefold * u2 * u2
        left[to + j] = (w0 * q0 + w1 * q1 + w2 * q2) / (w0 + w1 + w2)
        u0, u1, u2 = t1 * t2, t0 * t2, t0 * t1
        w0, w1, w2 = threefold * u0 * u0, sixfold * u1 * u1, u2 * u2
        right[to + j] = (w0 * q1 + w1 * q2 + w2 * q3) / (w0 + w1 + w2)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _derivatives(
    scheme: int, src: Floats, at: Indices, scale: float, left: Floats, right: Floats, to: Word, length: Word
) -> None:
    """Left and right derivative by the scheme's number (see :mod:`safestart.levelset.scheme`)."""
    if scheme == 0:
        _first_order(src, at, scale, left, right, to, length)
    elif scheme == 1:
        _eno2(src, at, scale, left, right, to, length)
    elif scheme == 2:
        _weno3(src, at, scale, left, right, to, length)
    elif scheme == 3:
        _eno3(src, at, scale, left, right, to, length)
    else:
        _weno5(src, at, scale, left, right, to, length)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST, forceinline=True)
def _beyond(value: float, inner: float, depth: float, boundary: int) -> float:
    """Value ``depth`` nodes beyond the end of an axis, from the last one and its neighbour."""
    slope = value - inner
    if boundary == AWAY:
        slope = abs(slope)
        if value < 0.0:
            slope = -slope
        elif value == 0.0:
            slope = value
    return value + depth * slope


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST, forceinline=True)
def _stencil(
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
                spare[to + j] = _beyond(v[start + j], v[inner + j], far, boundary)
    return True


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _blend(
    left: Floats,
    right: Floats,
    f: float,
    k: float,
    data: Floats,
    fo: Word,
    ko: Word,
    total: Floats,
    mean: Floats,
    to: Word,
    length: Word,
    keep: bool,
) -> None:
    """Lax-Friedrichs: total += f p + (|f| + k) (right - left) / 2; p, the mean of both sides, to ``mean`` if kept."""
    half = left.dtype.type(0.5)
    if keep:
        for j in range(length):
            rate = f + data[fo + j]
            p = half * (left[j] + right[j])
            total[j] += rate * p + (abs(rate) + k + data[ko + j]) * (half * (right[j] - left[j]))
            mean[to + j] = p
    else:
        for j in range(length):
            rate = f + data[fo + j]
            spread = abs(rate) + k + data[ko + j]
            total[j] += half * (rate * (left[j] + right[j]) + spread * (right[j] - left[j]))


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST, forceinline=True)
def _first_blend(
    src: Floats,
    at: Indices,
    scale: float,
    f: float,
    k: float,
    data: Floats,
    fo: Word,
    ko: Word,
    total: Floats,
    mean: Floats,
    to: Word,
    axis_to: Word,
    length: Word,
    keep: bool,
) -> None:
    """First-order derivatives and Lax-Friedrichs in one pass; quicker where a block has one rate."""
    fixed = fo == 0 and ko == 0
    half = src.dtype.type(0.5) * scale
    a, b, c = at[0], at[1], at[2]
    fo, ko, mo = fo + to, ko + to, axis_to + to
    if fixed:
        spread = abs(f) + k
        if keep:
            for j in range(length):
                low, high = src[a + j], src[c + j]
                p = half * (high - low)
                total[to + j] += f * p + spread * (half * (high + low - (src[b + j] + src[b + j])))
                mean[mo + j] = p
        else:
            for j in range(length):
                low, high = src[a + j], src[c + j]
                total[to + j] += half * (f * (high - low) + spread * (high + low - (src[b + j] + src[b + j])))
    else:
        for j in range(length):
            low, high = src[a + j], src[c + j]
            rate, p = f + data[fo + j], half * (high - low)
            bend = half * (high + low - (src[b + j] + src[b + j]))
            total[to + j] += rate * p + (abs(rate) + k + data[ko + j]) * bend
            mean[mo + j] = p


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _godunov(
    left: Floats,
    right: Floats,
    f: float,
    k: float,
    ft: Floats,
    fo: Word,
    ko: Word,
    total: Floats,
    length: Word,
) -> None:
    """Godunov for H(p) = f p + k |p|: its maximum over [left, right], or its minimum over [right, left]."""
    zero = left.dtype.type(0.0)
    for j in range(length):
        rate, kink = f + ft[fo + j], k + ft[ko + j]
        low, high = left[j], right[j]
        at_low, at_high = rate * low + kink * abs(low), rate * high + kink * abs(high)
        most, least = max(at_low, at_high), min(at_low, at_high)
        across = low * high < zero
        most = max(most, zero) if across else most
        least = min(least, zero) if across else least
        total[j] += most if low <= high else least


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST, forceinline=True)
def _entry(where: Whole, row: int, index: Whole, data: Floats) -> tuple[float, Word]:
    """Scalar part of a table for one block, and where its array part starts."""
    outer = len(index)
    scalar, start = where[row, 0], where[row, 1]
    for k in range(outer):
        scalar += where[row, 2 + k] * index[k]
        start += where[row, 2 + outer + k] * index[k]
    return data[scalar], np.uint64(start)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST, forceinline=True)
def _inputs(
    groups: Whole,
    channels: Whole,
    entries: Whole,
    bounds: Floats,
    where: Whole,
    data: Floats,
    axes: int,
    index: Whole,
    mean: Floats,
    share: Floats,
    size: Floats,
    total: Floats,
    length: Word,
) -> None:
    """total += sum over inputs of sign * (largest, or least, G u . p) with p in ``mean``."""
    span = np.uint64(length)
    zero = data.dtype.type(0.0)
    for g in range(len(groups)):
        ball, sign = groups[g, 0] == 1, data.dtype.type(groups[g, 1])
        price = bounds[g, 1]
        for c in range(groups[g, 2], groups[g, 3]):
            begin, end = channels[c, 0], channels[c, 1]
            gain, start = _entry(where, 3 * axes + begin, index, data)
            p = np.uint64(entries[begin] * length)
            if end == begin + 1 and start == 0 and ball:
                # The commonest input: one axis, the same gain everywhere.
                square = gain * gain
                if c == groups[g, 2]:
                    for j in range(span):
                        size[j] = square * mean[p + j] * mean[p + j]
                else:
                    for j in range(span):
                        size[j] += square * mean[p + j] * mean[p + j]
                continue
            for j in range(span):
                share[j] = (gain + data[start + j]) * mean[p + j]
            for e in range(begin + 1, end):
                gain, start = _entry(where, 3 * axes + e, index, data)
                p = np.uint64(entries[e] * length)
                for j in range(span):
                    share[j] += (gain + data[start + j]) * mean[p + j]
            if not ball:
                reach = sign * data[channels[c, 2]]
                for j in range(span):
                    total[j] += reach * max(abs(share[j]) - price, zero)
            elif c == groups[g, 2]:
                for j in range(span):
                    size[j] = share[j] * share[j]
            else:
                for j in range(span):
                    size[j] += share[j] * share[j]
        if ball:
            reach = sign * bounds[g, 0]
            for j in range(span):
                total[j] += reach * max(np.sqrt(size[j]) - price, zero)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST, forceinline=True)
def _close(out: Floats, center: int, length: Word, pitch: int, width: int, boundary: int) -> None:
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
                out[low - depth] = _beyond(out[low], out[low + 1], far, boundary)
                out[high + depth] = _beyond(out[high], out[high - 1], far, boundary)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
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
    2 floor, 3 both); ``shape``, ``strides`` (in ``v``), ``boundary`` and ``scale`` (1 / spacing) by axis; ``where`` and
    ``data`` the tables of :mod:`safestart.levelset.tables` (drift, spread and kink of each axis, then the gains).
    ``out`` may be ``first``, not ``v``.
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
    index = np.empty(outer, np.int64)
    fused = scheme == 0 and flux == LAX_FRIEDRICHS
    # Axes that an input moves: the others need not keep their mean slope.
    moved = np.zeros(axes, np.bool_)
    for axis in entries:
        moved[axis] = True
    for block in range(begin, end):
        rest = block
        for k in range(outer - 1, -1, -1):
            index[k] = rest % shape[k]
            rest //= shape[k]
        center = SLACK + block * length
        for j in range(size):
            total[j] = zero
        for axis in range(axes):
            # Off the block's axes a block is one run; along its second axis every row near an end is one of its own.
            across = axis < axes - 1
            inner = axis >= outer and across
            count, stride = (ends, pitch) if inner else (shape[axis], strides[axis])
            rate, rates = _entry(where, axis, index, data)
            kink, kinks = _entry(where, (2 * axes if flux == GODUNOV else axes) + axis, index, data)
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
                    copied = _stencil(
                        v, center + row * pitch, place, count, stride, boundary[axis], width, spare, run, at
                    )
                else:
                    for q in range(2 * width + 1):
                        at[q] = np.uint64(center + q - width)
                source = spare if copied else v
                if fused:
                    _first_blend(
                        source, at, scale[axis], rate, kink, data, rates, kinks, total, mean,
                        np.uint64(row * pitch), to, np.uint64(run), moved[axis],
                    )  # fmt: skip
                else:
                    part, span = np.uint64(row * pitch), np.uint64(run)
                    _derivatives(scheme, source, at, scale[axis], left, right, part, span)
                row += rows
            if flux == GODUNOV:
                _godunov(left, right, rate, kink, data, rates, kinks, total, size)
            elif not fused:
                _blend(left, right, rate, kink, data, rates, kinks, total, mean, to, size, moved[axis])
        if flux == LAX_FRIEDRICHS:
            _inputs(
                groups, channels, entries, bounds, where, data, axes, index, mean, share, norm, total, length
            )
        start = np.uint64(center)
        # Comparisons are turned so that NaN survives: it must be seen, not cut off.
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
            level, levels = _entry(clamp_where, 0, index, clamp)
            for j in range(size):
                bound = level + clamp[levels + j]
                out[start + j] = bound if out[start + j] > bound else out[start + j]
        if clamps & 2:
            level, levels = _entry(clamp_where, 1, index, clamp)
            for j in range(size):
                bound = level + clamp[levels + j]
                out[start + j] = bound if out[start + j] < bound else out[start + j]
        _close(out, center, length, pitch, width, boundary[axes - 1])


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def fastest(shape: Whole, plan: Whole, scale: Floats, where: Whole, data: Floats) -> float:
    """Largest sum over axes of (|f| + spread) / spacing on the nodes: 1 / (longest stable step)."""
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
            rate, rates = _entry(where, axis, index, data)
            spread, spreads = _entry(where, axes + axis, index, data)
            factor = scale[axis]
            for j in range(size):
                step = (abs(rate + data[rates + j]) + spread + data[spreads + j]) * factor
                sums[j] = sums[j] + step if axis > 0 else step
        for j in range(size):
            most = max(most, sums[j])
    return most
