"""How the parts of the compiled sweep are compiled, and the types of what they read."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Indices = NDArray[np.uint64]
Whole = NDArray[np.int64]
Word = Any
"""An index: uint64 where it is used in a loop."""
Value = Any
"""A number of the arrays' precision."""

FAST = {"contract", "nsz"}
"""Fused multiply-add, and -0 as good as 0; nothing that lets NaN be assumed away."""

# Parts are not cached: what is, with everything it calls, is the entry point (see :mod:`safestart.runtime.stamp`).
part = njit(nogil=True, error_model="numpy", fastmath=FAST)
"""Compile a function that entry points call."""
inlined = njit(nogil=True, error_model="numpy", fastmath=FAST, forceinline=True)
"""The same for what is called for every block: passing a dozen arrays costs as much as their work."""
