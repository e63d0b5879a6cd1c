"""MATLAB 5: the arrays of NPZ under names that MATLAB takes, ``table__column`` for ``table.column``.

The first file loads SciPy.
"""

from __future__ import annotations

from safestart_service.documents.formats.base import Format, Record
from safestart_service.documents.formats.npz import arrays_of

LONGEST_NAME = 63


def _encode(record: Record, _: str | None) -> bytes:
    from safestart.interchange.tables.matlab_write import matlab_of

    found = {name.replace(".", "__")[:LONGEST_NAME]: array for name, array in arrays_of(record).items()}
    return matlab_of(found)


FORMAT = Format("mat", "application/x-matlab-data", _encode)
