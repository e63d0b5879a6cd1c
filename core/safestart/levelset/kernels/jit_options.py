"""Compilation options of the sweep's parts, and the types of their arguments."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from safestart.runtime.kernels import parts as kernel_parts

Indices = NDArray[np.uint64]
Whole = NDArray[np.int64]
Word = Any
"""An index: uint64 inside loops."""
Value = Any
"""A number in the arrays' precision."""

FAST = {"contract", "nsz"}
"""Allow fused multiply-add and ignore the sign of zero; allow nothing that assumes away NaN."""

# No wrappers: only kernels call them.
_BARE: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": FAST}


# Parts are not cached; the entry point is, with everything that it calls (:mod:`safestart.runtime.kernels.compiled`).
def part(function: Callable[..., Any]) -> Any:
    """Decorator for functions that entry points call."""
    return kernel_parts.part(function, **_BARE)


def inlined(function: Callable[..., Any]) -> Any:
    """The same for functions called per block; inlined, as passing a dozen arrays costs as much as the work."""
    return kernel_parts.part(function, **_BARE, forceinline=True)
