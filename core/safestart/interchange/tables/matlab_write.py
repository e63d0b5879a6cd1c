"""MATLAB 5 files from named arrays; equal arrays are equal bytes."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

_HEAD = 116
"""Bytes of free text at the begin of a file, in which SciPy writes the time."""


def matlab_of(columns: Mapping[str, Any]) -> bytes:
    """Numbers as float64 matrices with a row for each entry, texts as cells."""
    from scipy.io import savemat

    sink = io.BytesIO()
    found = {}
    for name, column in columns.items():
        array = np.atleast_1d(np.asarray(column))
        text = array.dtype.kind == "U"
        found[name] = (array.astype(object) if text else array.astype(np.float64)).reshape(
            len(array), math.prod(array.shape[1:])
        )
    # It takes files too, whatever its stubs say.
    savemat(cast(Any, sink), found, do_compression=True, long_field_names=True)
    return b"MATLAB 5.0 MAT-file, safestart".ljust(_HEAD) + sink.getvalue()[_HEAD:]
