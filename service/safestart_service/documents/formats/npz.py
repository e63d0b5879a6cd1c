"""NPZ: every numeric output as an array; columns of tables as ``table.column``, with NaN for missing values.

The first file loads NumPy.
"""

from __future__ import annotations

import io
from typing import Any

from safestart.processes.tables import columns_of, tables_of
from safestart_service.documents.formats.base import Format, Record


def _encode(record: Record, _: str | None) -> bytes:
    import numpy as np

    sink = io.BytesIO()
    np.savez_compressed(sink, **arrays_of(record))
    return sink.getvalue()


def arrays_of(record: Record) -> dict[str, Any]:
    """The arrays of a result by name."""
    outputs = record["outputs"]
    arrays: dict[str, Any] = {}
    for name, value in outputs.items():
        if isinstance(value, int | float | list) and (array := _numeric(value)) is not None:
            arrays[name] = array
    for name, rows in tables_of(outputs).items():
        for column in columns_of(rows):
            if (array := _numeric([row[column] for row in rows])) is not None:
                arrays[f"{name}.{column}"] = array
    return arrays


def _numeric(value: Any) -> Any:
    """An array of numbers or truth values, None for anything else (text, ragged lists)."""
    import numpy as np

    try:
        array = np.array(value)
        if array.dtype == object:
            array = np.array(value, dtype=np.float64)  # None becomes NaN
    except (TypeError, ValueError):
        return None
    return array if array.dtype.kind in "biuf" else None


FORMAT = Format("npz", "application/x-npz", _encode)
