"""An example form of a result: the rows of a table as JSON, one a line."""

from __future__ import annotations

import orjson

from safestart_service.documents.formats.base import Format, Record, rows_of


def _encode(record: Record, table: str | None) -> bytes:
    return b"".join(orjson.dumps(row) + b"\n" for row in rows_of(record, table))


FORMAT = Format("jsonl", "application/jsonl", _encode, rows=True)
