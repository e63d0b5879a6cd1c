"""Distances between two samples: the cubic through value and slope at both, and its minimum."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats


def dips(value: Floats, slope: Floats) -> tuple[Floats, Floats]:
    """Minimum of the cubic over each sample and where it lies in [0, 1], both (..., S, F).

    ``value`` and ``slope`` (slope times the sample's length) go (..., S+1, F).
    """
    left, right = value[..., :-1, :], value[..., 1:, :]
    begin, end = slope[..., :-1, :], slope[..., 1:, :]
    rise = right - left
    bend = begin + end - 2.0 * rise
    square = 3.0 * rise - 2.0 * begin - end
    inner = square * square - 3.0 * bend * begin
    root = np.sqrt(np.maximum(inner, 0.0))
    # The larger root of the slope, where the cubic has its minimum, written without cancellation: a slope of 0 at the
    # beginning, as of a start at rest, must not hide a minimum behind it.
    top = np.where(square < 0.0, root - square, -begin)
    bottom = np.where(square < 0.0, 3.0 * bend, square + root)
    inside = (inner > 0.0) & (top > 0.0) & (top < bottom)
    place = top / np.where(inside, bottom, 1.0)
    value = left + place * (begin + place * (square + place * bend))
    ends = np.minimum(left, right)
    inside &= value <= ends
    at = np.where(inside, place, np.where(right < left, 1.0, 0.0))
    return np.where(inside, value, ends), at
