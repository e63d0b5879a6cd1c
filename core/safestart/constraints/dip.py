"""The least value of one cubic between two samples, compiled; :mod:`safestart.constraints.cubic` for arrays of them."""

from __future__ import annotations

import math
from typing import Any

from safestart.runtime.kernels.compiled import compiled


@compiled(error_model="numpy")
def dip(left: float, right: float, begin: float, end: float) -> Any:
    """Minimum over [0, 1] of the cubic through ``left``, ``right`` with slopes ``begin``, ``end``, and its place."""
    rise = right - left
    bend = begin + end - 2.0 * rise
    square = 3.0 * rise - 2.0 * begin - end
    low, at = left, 0.0
    if right < left:
        low, at = right, 1.0
    if begin < 0.0 or square < 0.0:
        inner = square * square - 3.0 * bend * begin
        if inner > 0.0:
            # The larger root of the slope where bend > 0, written without cancellation.
            top, bottom = -begin, square + math.sqrt(inner)
            if square < 0.0:
                top, bottom = math.sqrt(inner) - square, 3.0 * bend
            if 0.0 < top < bottom:
                place = top / bottom
                value = left + place * (begin + place * (square + place * bend))
                if value <= low:
                    low, at = value, place
    return low, at
