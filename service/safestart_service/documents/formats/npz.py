"""NPZ: every numeric output as an array; columns of tables as ``table.column``, with NaN for missing values.

Types are the process's: float64 for numbers, int64 and bool where no value may be missing, else float64. The first
file loads NumPy.
"""

from __future__ import annotations

import io
from typing import Any

from safestart.processes.tables import Kind, typed_tables
from safestart.processes.tables.columns import output_arrays
from safestart.processes.tables.typed import known_process
from safestart_service.documents.formats.base import Format, Record


def _encode(record: Record, _: str | None) -> bytes:
    import numpy as np

    sink = io.BytesIO()
    np.savez_compressed(sink, **arrays_of(record))
    return sink.getvalue()


def arrays_of(record: Record) -> dict[str, Any]:
    """The arrays of a result by name."""
    arrays: dict[str, Any] = {}
    outputs, spec = record["outputs"], known_process(record)
    if spec is None:
        for name, value in outputs.items():
            if isinstance(value, int | float | list) and (array := _numeric(value)) is not None:
                arrays[name] = array
    else:
        for name, one in output_arrays(spec).items():
            value = outputs.get(name)
            if value is None:
                value = [] if one.shape else float("nan")
            if (array := _typed(value, one.kind, nullable=one.nullable)) is not None:
                arrays[name] = _in_shape(array, one.shape)
    for name, table in typed_tables(record).items():
        for column, kind in table.kinds.items():
            if kind is not Kind.TEXT:
                nullable = column in table.nullable
                arrays[f"{name}.{column}"] = _typed(table.cells[column], kind, nullable=nullable)
    return arrays


def _typed(values: Any, kind: Kind, *, nullable: bool) -> Any:
    """An array of the type; numbers of cells become rows as long as the longest, None lists that are ragged."""
    import numpy as np

    if kind is Kind.NUMBERS:
        width = max((len(row) for row in values if row), default=0)
        rows = [[*(row or ()), *[None] * (width - len(row or ()))] for row in values]
        return np.array(rows, dtype=np.float64).reshape(len(values), width)
    exact = {Kind.FLAG: np.bool_, Kind.INTEGER: np.int64}.get(kind)
    try:
        return np.array(values, dtype=np.float64 if nullable or exact is None else exact)
    except (TypeError, ValueError, OverflowError):
        return None


def _in_shape(array: Any, least: tuple[int, ...]) -> Any:
    """An empty array with all axes of its description: a list without points says nothing of a point's length."""
    if array.size or array.ndim >= len(least):
        return array
    return array.reshape(*array.shape, *least[array.ndim :])


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
