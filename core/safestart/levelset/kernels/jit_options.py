"""Compilation options of the sweep's parts, and the types of their arguments."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Indices = NDArray[np.uint64]
Whole = NDArray[np.int64]
Word = Any
"""An index: uint64 inside loops."""
Value = Any
"""A number in the arrays' precision."""

FAST = {"contract", "nsz"}
"""Allow fused multiply-add and ignore the sign of zero; allow nothing that assumes away NaN."""

# Parts are not cached; the entry point is, with everything that it calls (see :mod:`safestart.runtime.kernels`).
part = njit(nogil=True, error_model="numpy", fastmath=FAST)
"""Decorator for functions that entry points call."""
inlined = njit(nogil=True, error_model="numpy", fastmath=FAST, forceinline=True)
"""The same for functions called per block; inlined, as passing a dozen arrays costs as much as the work."""
