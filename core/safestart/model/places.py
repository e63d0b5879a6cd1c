"""Places of pydantic's reports as a client knows them: by the names of fields alone.

pydantic puts the tag of a union's member into the place, ``orbit.elliptic.eccentricity``; no client wrote it.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel


def placed(model: type[BaseModel], reports: Iterable[Any]) -> list[Any]:
    """The reports of one validation by ``model``, their places without tags.

    Each gets ``fields``, the names that the object at its place may have; none where that is no model.
    """
    return [_placed(model.__pydantic_core_schema__, report) for report in reports]


def _placed(schema: Any, report: Any) -> Any:
    known: dict[str, Any] = {}
    place: list[int | str] = []
    schema = _inner(schema, known)
    for part in report["loc"]:
        kind = schema.get("type")
        if kind == "tagged-union":
            below = schema["choices"].get(part, {})
        else:
            place.append(part)
            below = schema["fields"].get(part, {}) if kind == "model-fields" else {}
            below = schema.get("items_schema", {}) if kind == "list" else below
        schema = _inner(below, known)
    fields = schema["fields"] if schema.get("type") == "model-fields" else ()
    return {**report, "loc": tuple(place), "fields": tuple(fields)}


def _inner(schema: Any, known: dict[str, Any]) -> Any:
    """The schema below what only wraps it; ``known`` are the definitions that references name."""
    while True:
        if schema.get("type") == "definitions":
            known |= {one["ref"]: one for one in schema["definitions"]}
        if schema.get("type") == "definition-ref":
            schema = known.get(schema["schema_ref"], {})
        elif "schema" in schema:
            schema = schema["schema"]
        else:
            return schema
