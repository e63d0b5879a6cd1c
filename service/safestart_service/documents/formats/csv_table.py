"""CSV (RFC 4180), with a header line; missing values are empty, several numbers of a cell stand between spaces."""

from __future__ import annotations

import csv
import io
from typing import Any

from safestart_service.documents.formats.base import Format, Record, table_of


def _encode(record: Record, table: str | None) -> bytes:
    found = table_of(record, table)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\r\n")
    writer.writerow(found.cells)
    writer.writerows(map(_written, row) for row in zip(*found.cells.values(), strict=True))
    return text.getvalue().encode()


def _written(cell: Any) -> Any:
    if isinstance(cell, list):
        return " ".join("nan" if item is None else repr(item) for item in cell)
    return cell


FORMAT = Format("csv", "text/csv", _encode, rows=True)
