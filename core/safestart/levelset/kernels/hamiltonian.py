"""Compiled part of the sweep: numerical Hamiltonians, and the players' inputs."""

from __future__ import annotations

import numpy as np

from safestart.levelset.kernels.jit_options import Indices, Whole, Word, inlined, part
from safestart.levelset.kernels.table import entry
from safestart.model.scenario import Floats


@part
def blend(
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


@inlined
def first_blend(
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
    """First-order derivatives and Lax-Friedrichs in one pass; faster when a block has one rate."""
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


@part
def godunov(
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


@inlined
def add_inputs(
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
            gain, start = entry(where, 3 * axes + begin, index, data)
            p = np.uint64(entries[begin] * length)
            if end == begin + 1 and start == 0 and ball:
                # The most common input: one axis, the same gain everywhere.
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
                gain, start = entry(where, 3 * axes + e, index, data)
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
