"""The formats of a result, one line each, in order of preference: a client that accepts any gets the first."""

from __future__ import annotations

from hashlib import sha256

from safestart.model.registry import by_name
from safestart.runtime.named import misregistered, module_of
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


def format_in(module: str) -> Format:
    """The ``FORMAT`` of a module in this folder; raises ``Misregistered`` for a module without one."""
    found = getattr(module_of(f"{__package__}.{module}", "formats"), "FORMAT", None)
    if not isinstance(found, Format):
        raise misregistered("formats", f"a Format named FORMAT in {module}.py", found)
    return found


FORMATS: tuple[Format, ...] = tuple(map(format_in, _MODULES))
BY_NAME = by_name("formats", FORMATS, lambda form: form.name)
BY_TYPE = by_name("media types", FORMATS, lambda form: form.media_type)


def tag_of(form: Format, table: str | None) -> str:
    """Distinguishes this format's entity tag from the record's."""
    return "" if form is FORMATS[0] else f"-{form.name}-{sha256((table or '').encode()).hexdigest()[:8]}"
