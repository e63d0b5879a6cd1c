"""Parquet, one row group. The first file loads pyarrow."""

from __future__ import annotations

import io
from typing import Any

from safestart.errors import Unavailable
from safestart.processes.tables import columns_of
from safestart_service.documents.formats.base import Format, Record, rows_of


def _encode(record: Record, table: str | None) -> bytes:
    rows = rows_of(record, table)
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ModuleNotFoundError:
        raise Unavailable(
            "Parquet requires the package pyarrow, which is not installed here",
            required="the package pyarrow",
        ) from None
    sink = io.BytesIO()
    columns = {name: _uniform([row.get(name) for row in rows]) for name in columns_of(rows)}
    pq.write_table(pa.table(columns), sink)
    return sink.getvalue()


def _uniform(values: list[Any]) -> list[Any]:
    """A column of one type: integers mixed with floats become floats, any other mixture becomes text."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        return [None if value is None else float(value) for value in values]
    if len(kinds) > 1:
        return [None if value is None else str(value) for value in values]
    return values


FORMAT = Format("parquet", "application/vnd.apache.parquet", _encode, rows=True)
