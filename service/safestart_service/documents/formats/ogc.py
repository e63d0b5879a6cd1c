"""The results document of OGC API - Processes 1.0."""

from __future__ import annotations

from typing import Any

import orjson

from safestart_service.documents.formats.base import Format, Record


def ogc_values(outputs: dict[str, Any]) -> dict[str, Any]:
    """Outputs as the standard defines them: objects are qualified, and null outputs are left out."""
    return {
        name: {"value": value, "mediaType": "application/json"} if isinstance(value, dict) else value
        for name, value in outputs.items()
        if value is not None
    }


def ogc_results(record: Record) -> dict[str, Any]:
    """Values by output id, artifacts as links."""
    document = ogc_values(record["outputs"])
    for file in record["artifacts"]:
        document[file["name"]] = {"href": file["href"], "type": file["media_type"], "title": file["name"]}
    return document


def _encode(record: Record, _: str | None) -> bytes:
    return orjson.dumps(ogc_results(record))


FORMAT = Format("ogc", "application/json", _encode, document=True)
