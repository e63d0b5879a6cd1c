"""CSV (RFC 4180), with a header line; missing values are empty."""

from __future__ import annotations

import csv
import io

from safestart.processes.tables import columns_of
from safestart_service.documents.formats.base import Format, Record, rows_of


def _encode(record: Record, table: str | None) -> bytes:
    rows = rows_of(record, table)
    text = io.StringIO()
    writer = csv.DictWriter(text, columns_of(rows), lineterminator="\r\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()


FORMAT = Format("csv", "text/csv", _encode, rows=True)
