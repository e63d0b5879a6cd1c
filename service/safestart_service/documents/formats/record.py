"""Our record: inputs, outputs, provenance, artifacts."""

from __future__ import annotations

import orjson

from safestart_service.documents.formats.base import Format, Record
from safestart_service.documents.schemas import ResultDocument


def _encode(record: Record, _: str | None) -> bytes:
    return orjson.dumps(record)


FORMAT = Format(
    "record", "application/vnd.safestart.result+json", _encode, document=True, model=ResultDocument
)
