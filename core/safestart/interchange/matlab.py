"""MATLAB 5 files: named arrays in and out; equal arrays are equal bytes."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

from safestart.errors import invalid

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
            len(array), array.size // max(len(array), 1)
        )
    # It takes files too, whatever its stubs say.
    savemat(cast(Any, sink), found, do_compression=True, long_field_names=True)
    return b"MATLAB 5.0 MAT-file, safestart".ljust(_HEAD) + sink.getvalue()[_HEAD:]


def arrays_in(data: bytes) -> dict[str, list[Any]]:
    """Numbers or texts of each array, flat; raises ``InvalidInput`` for anything but a MATLAB 5 file."""
    from scipy.io import loadmat

    try:
        loaded = loadmat(cast(Any, io.BytesIO(data)), mat_dtype=True)
    except Exception as error:
        # The reader raises whatever its parts do on a damaged file.
        raise invalid(
            "file", "a MATLAB 5 file", f"one that is not ({type(error).__name__}: {error})"
        ) from None
    found: dict[str, list[Any]] = {}
    for name, array in loaded.items():
        if name.startswith("__"):
            continue
        flat = np.asarray(array).ravel()
        if flat.dtype == object:
            found[name] = [str(np.asarray(entry).ravel()[0]) if np.size(entry) else "" for entry in flat]
        elif flat.dtype.kind == "U":
            found[name] = [str(entry).rstrip() for entry in flat]
        elif flat.dtype.kind in "biuf":
            found[name] = [float(entry) for entry in flat]
        else:
            raise invalid(name, "numbers or texts", str(flat.dtype))
    return found
