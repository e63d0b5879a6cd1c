"""The formats of a result, one line each, in order of preference: a client that accepts any gets the first."""

from __future__ import annotations

from hashlib import sha256
from importlib import import_module

from safestart_service.documents.formats.base import Format

_MODULES = (
    "record",
    "ogc",
    "csv_table",
    "npz",
    "parquet",
    "matlab",
    "ccsds",
    "czml",
)

FORMATS: tuple[Format, ...] = tuple(
    import_module(f"safestart_service.documents.formats.{module}").FORMAT for module in _MODULES
)
BY_NAME = {form.name: form for form in FORMATS}
BY_TYPE = {form.media_type: form for form in FORMATS}


def tag_of(form: Format, table: str | None) -> str:
    """Distinguishes this format's entity tag from the record's."""
    return "" if form is FORMATS[0] else f"-{form.name}-{sha256((table or '').encode()).hexdigest()[:8]}"
