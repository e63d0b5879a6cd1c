"""Records of cases as Parquet: written by each shard, joined by the merge."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence

import pyarrow as pa
import pyarrow.parquet as pq

from safestart.campaign.table import Column, Kind, Table
from safestart.records.parquet import read

MEDIA_TYPE = "application/vnd.apache.parquet"

_TYPES = {
    Kind.INTEGER: pa.int64(),
    Kind.SMALL: pa.int32(),
    Kind.NUMBER: pa.float64(),
    Kind.FLAG: pa.bool_(),
    Kind.TEXT: pa.string(),
}


def schema(columns: Iterable[Column]) -> pa.Schema:
    """The Arrow schema of the recorded columns."""
    return pa.schema([pa.field(column.name, _TYPES[column.kind]) for column in columns if column.recorded])


def parquet(table: Table) -> bytes:
    """The recorded columns as one Parquet file; empty bytes without a row."""
    if not len(table):
        return b""
    wanted = schema(table.columns)
    arrays = [
        pa.array(table.values[field.name], type=field.type, mask=~table.known(field.name)) for field in wanted
    ]
    return _written([pa.Table.from_arrays(arrays, schema=wanted)], wanted)


def joined(columns: Sequence[Column], files: Iterable[bytes]) -> bytes:
    """One file from those of the shards, a row group each; read and written one at a time."""
    return _written((read(data) for data in files if data), schema(columns))


def _written(tables: Iterable[pa.Table], columns: pa.Schema) -> bytes:
    buffer = io.BytesIO()
    with pq.ParquetWriter(buffer, columns, compression="zstd") as writer:
        for table in tables:
            writer.write_table(table)
    return buffer.getvalue()
