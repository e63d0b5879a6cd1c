"""Arrays from what users write: numbers alone, as ``np.asarray`` makes 1.0 of ``True`` and 40.0 of ``"40"``."""

from __future__ import annotations

from numbers import Real
from typing import TYPE_CHECKING

import numpy as np

from safestart.model.scenario import Floats

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def float_array(values: ArrayLike) -> Floats:
    """A new float64 array; raises ``TypeError`` or ``ValueError`` for booleans, text and ragged lists."""
    found = np.asarray(values) if hasattr(values, "__array__") else np.asarray(values, dtype=object)
    if found.dtype == object:
        plain = [_plain(one) for one in found.ravel().tolist()]
        found = np.array(plain, dtype=object).reshape(found.shape)
        kinds = set(map(type, plain))
        if bool in kinds or not all(issubclass(kind, Real) for kind in kinds):
            raise TypeError("required numbers")
    elif found.dtype.kind not in "iuf":
        raise TypeError("required numbers")
    out: Floats = np.array(found, dtype=np.float64)
    return out


def _plain(value: object) -> object:
    """The number in an array without axes, of NumPy or another library."""
    return np.asarray(value).item() if getattr(value, "shape", None) == () else value
