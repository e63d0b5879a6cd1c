"""The forms of a result, one line each, in order of preference: who takes anything gets the first."""

from __future__ import annotations

from hashlib import sha256

from safestart_service.documents.formats import csv_table, npz, ogc, parquet, record
from safestart_service.documents.formats.base import Format

FORMATS: tuple[Format, ...] = (
    record.FORMAT,
    ogc.FORMAT,
    csv_table.FORMAT,
    npz.FORMAT,
    parquet.FORMAT,
)

BY_NAME = {form.name: form for form in FORMATS}
BY_TYPE = {form.media_type: form for form in FORMATS}


def tag_of(form: Format, table: str | None) -> str:
    """What tells this form's entity tag from the record's."""
    return "" if form is FORMATS[0] else f"-{form.name}-{sha256((table or '').encode()).hexdigest()[:8]}"
