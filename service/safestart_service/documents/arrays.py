"""NPZ artifacts as JSON, for readers without NumPy."""

from __future__ import annotations

import io
import zipfile
from typing import Any

from safestart.errors import NotFound, invalid
from safestart.records.artifact import Artifact

MOST_NUMBERS = 1_000_000


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
    except (ValueError, OSError, zipfile.BadZipFile):
        raise invalid("name", "an NPZ artifact", "a file that cannot be read") from None
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
        array = found[name]
        total += array.size
        if total > MOST_NUMBERS:
            raise invalid("names", f"arrays of at most {MOST_NUMBERS} numbers in all", total)
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            array = np.where(np.isfinite(array), array.astype(object), None)
        arrays[name] = array.tolist()
    return arrays
