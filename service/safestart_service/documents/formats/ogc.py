"""The results document of OGC API - Processes 1.0."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import orjson

from safestart_service.documents.formats.base import Format, Record


def ogc_members(outputs: Iterable[tuple[str, Any]]) -> Iterator[tuple[str, Any]]:
    """Outputs as the standard defines them: objects are qualified, and null outputs are left out."""
    for name, value in outputs:
        if isinstance(value, dict):
            yield name, {"value": value, "mediaType": "application/json"}
        elif value is not None:
            yield name, value


def ogc_results(record: Record) -> dict[str, Any]:
    """Values by output id, artifacts as links."""
    document = dict(ogc_members(record["outputs"].items()))
    for file in record["artifacts"]:
        document[file["name"]] = {"href": file["href"], "type": file["media_type"], "title": file["name"]}
    return document


def _encode(record: Record, _: str | None) -> bytes:
    return orjson.dumps(ogc_results(record))


FORMAT = Format("ogc", "application/json", _encode, document=True)
