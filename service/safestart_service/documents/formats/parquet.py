"""Parquet, one row group; types are the process's, whatever the values. The first file loads pyarrow."""

from __future__ import annotations

import io

from safestart.errors import Unavailable
from safestart.processes.tables import Kind
from safestart_service.documents.formats.base import Format, Record, table_of


def _encode(record: Record, table: str | None) -> bytes:
    found = table_of(record, table)
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ModuleNotFoundError:
        raise Unavailable(
            "Parquet requires the package pyarrow, which is not installed here",
            required="the package pyarrow",
        ) from None
    types = {
        Kind.FLAG: pa.bool_(),
        Kind.INTEGER: pa.int64(),
        Kind.NUMBER: pa.float64(),
        Kind.TEXT: pa.string(),
        Kind.NUMBERS: pa.list_(pa.float64()),
    }
    schema = pa.schema([(name, types[kind]) for name, kind in found.kinds.items()])
    sink = io.BytesIO()
    pq.write_table(pa.table(found.cells, schema=schema), sink)
    return sink.getvalue()


FORMAT = Format("parquet", "application/vnd.apache.parquet", _encode, rows=True)
