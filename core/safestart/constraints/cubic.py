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
    square = 3.0 * rise - 2.0 * begin - end
    root = np.sqrt(np.maximum(square * square - 3.0 * (begin + end - 2.0 * rise) * begin, 0.0))
    below = square + root
    # -begin / (square + root) is the cubic's minimum; it lies in the sample when 0 < -begin < square + root.
    inside = (begin < 0.0) & (below > -begin)
    at = np.where(inside, -begin / np.where(inside, below, 1.0), np.where(right < left, 1.0, 0.0))
    low = left + at * (begin + at * (square + at * (begin + end - 2.0 * rise)))
    return low, at
