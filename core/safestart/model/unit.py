"""Directions of vectors of any length, without underflow or overflow."""

from __future__ import annotations

import numpy as np

from safestart.model.scenario import Floats

# Between these limits the squares neither underflow nor overflow.
_SHORT, _LONG = 1e-140, 1e140


def unit(vectors: Floats) -> Floats:
    """Vectors (..., m) of length 1, to rounding, in the directions of ``vectors``; zero where they are zero.

    The square of 1e-160 keeps only a few bits, and dividing by the root of such squares gives an error of several
    per cent. Such vectors are scaled first.
    """
    largest = np.abs(vectors).max(axis=-1, keepdims=True, initial=0.0)
    odd = (largest != 0.0) & ((largest < _SHORT) | (largest > _LONG))
    scaled = np.divide(vectors, largest, out=vectors.copy(), where=odd) if odd.any() else vectors
    size = np.linalg.norm(scaled, axis=-1, keepdims=True)
    out: Floats = np.divide(scaled, size, out=np.zeros_like(scaled), where=size > 0.0)
    return out
