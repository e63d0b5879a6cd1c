"""NPZ artifacts as JSON, for readers without NumPy."""

from __future__ import annotations

import io
import math
import zipfile
import zlib
from typing import Any

from safestart.errors import InvalidInput, NotFound, invalid
from safestart.records.artifact import Artifact

MOST_NUMBERS = 1_000_000
# Complex numbers, the widest; and a header.
_MOST_BYTES = 16 * MOST_NUMBERS + 4096


def arrays_of(file: Artifact, names: str | None) -> dict[str, Any]:
    """Arrays by name as nested lists, NaN and infinity as None.

    Raises ``InvalidInput`` for a file that is not NPZ and for more than a million numbers, and ``NotFound`` for an
    unknown name.
    """
    import numpy as np

    if file.media_type != "application/x-npz":
        raise invalid("name", "an NPZ artifact", file.media_type)
    try:
        found = np.load(io.BytesIO(file.data), allow_pickle=False)
        sizes = {info.filename.removesuffix(".npy"): info.file_size for info in found.zip.infolist()}
    except (AttributeError, ValueError, OSError, EOFError, zipfile.BadZipFile):
        raise _unreadable() from None
    wanted = found.files if names is None else [name.strip() for name in names.split(",")]
    for name in wanted:
        if name not in found.files:
            there_are = ", ".join(found.files)
            raise NotFound(
                f"{file.name} has no array {name!r}; there are: {there_are}",
                field="names",
                required=f"some of {there_are}",
                received=name,
            )
    arrays, total = {}, 0
    for name in wanted:
        # Unpacked only when it is small: a packed array of zeros has a thousandth of its size.
        if sizes[name] > _MOST_BYTES:
            raise _too_many(sizes[name] // 8)
        array = _array(found, name, sizes[name])
        total += array.size
        if total > MOST_NUMBERS:
            raise _too_many(total)
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            array = np.where(np.isfinite(array), array.astype(object), None)
        arrays[name] = array.tolist()
    return arrays


def _array(found: Any, name: str, size: int) -> Any:
    """The array ``name``, whose file has ``size`` bytes; its header is believed only as far as these go."""
    import numpy as np
    from numpy.lib import format as npy

    file = f"{name}.npy" if f"{name}.npy" in found.zip.namelist() else name
    try:
        with found.zip.open(file) as opened:
            version = npy.read_magic(opened)
            read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
            shape, _, kind = read(opened)
        if kind.hasobject or math.prod(shape) * kind.itemsize > size:
            raise _unreadable()
        array = found[name]
    except (ValueError, OSError, EOFError, zipfile.BadZipFile, zlib.error):
        raise _unreadable() from None
    return np.asarray(array)


def _unreadable() -> InvalidInput:
    return invalid("name", "an NPZ artifact", "a file that cannot be read")


def _too_many(number: int) -> InvalidInput:
    return invalid("names", f"arrays of at most {MOST_NUMBERS} numbers in all", number)
