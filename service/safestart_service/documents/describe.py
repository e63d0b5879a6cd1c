"""Process descriptions of OGC API - Processes 1.0, made from the specs."""

from __future__ import annotations

from dataclasses import asdict
from functools import cache
from typing import Any, Literal

from pydantic import BaseModel

from safestart.errors import NotFound
from safestart.processes import views
from safestart.processes.base import ProcessSpec
from safestart.processes.registry import PROCESS_IDS, process
from safestart_service.documents.dialects import common
from safestart_service.errors import NoSuchProcess
from safestart_service.http.answers import link

EXECUTE_REL = "http://www.opengis.net/def/rel/ogc/1.0/execute"


def known_process(process_id: str) -> ProcessSpec:
    """The spec named in a path; raises ``NoSuchProcess``."""
    try:
        return process(process_id)
    except NotFound as error:
        raise NoSuchProcess(
            error.detail, field=error.field, required=error.required, received=error.received
        ) from None


def summary(spec: ProcessSpec, base: str) -> dict[str, Any]:
    """Entry of a process in the list."""
    here = f"{base}/processes/{spec.id}"
    return {
        "id": spec.id,
        "title": spec.title,
        "description": spec.description,
        "version": spec.version,
        "keywords": list(spec.keywords),
        "jobControlOptions": [*(["sync-execute"] if spec.light else []), "async-execute", "dismiss"],
        "outputTransmission": ["value"],
        "safestart:view_kinds": views.kinds(spec.views),
        "links": [
            link(here, "self", "this process"),
            link(f"{here}/execution", EXECUTE_REL, "execute it"),
        ],
    }


def description(spec: ProcessSpec, base: str) -> dict[str, Any]:
    """Full description of a process."""
    return {**summary(spec, base), **_interface(spec), **_looks(spec), **spec.extensions}


def _looks(spec: ProcessSpec) -> dict[str, Any]:
    """How a page shows the outputs: additions to the standard, under our own names."""
    return {
        "safestart:tables": [asdict(table) for table in spec.tables],
        "safestart:views": views.documents(spec.views),
    }


def output_ids(spec: ProcessSpec) -> tuple[str, ...]:
    """Names of a process's outputs."""
    return tuple(spec.outputs.model_fields)


@cache
def verdict_words() -> tuple[str, ...]:
    """The words of verdicts that any process may give, those that decide for it first."""
    found = [view for name in PROCESS_IDS for view in process(name).views if isinstance(view, views.Findings)]
    good, bad = ([word for view in found for word in getattr(view, sense)] for sense in ("good", "bad"))
    return tuple(dict.fromkeys((*good, *bad, "UNDECIDED")))


def described_inputs(process_id: str) -> dict[str, Any]:
    """The inputs of a process by name, as in its description."""
    found: dict[str, Any] = _interface_of(process_id)["inputs"]
    return found


def _interface(spec: ProcessSpec) -> dict[str, Any]:
    return _interface_of(spec.id)


@cache
def _interface_of(process_id: str) -> dict[str, Any]:
    spec = process(process_id)
    inputs, required = _properties(spec.inputs, "validation")
    outputs, _ = _properties(spec.outputs, "serialization")
    for name, entry in inputs.items():
        entry["minOccurs"] = 1 if name in required else 0
        entry["maxOccurs"] = 1
    return {"inputs": inputs, "outputs": outputs, "example": spec.example}


def _properties(
    model: type[BaseModel], mode: Literal["validation", "serialization"]
) -> tuple[dict[str, dict[str, Any]], frozenset[str]]:
    """Title, description and self-contained schema of each field, and the names of the required fields."""
    schema = model.model_json_schema(mode=mode)
    definitions = schema.get("$defs", {})
    entries = {}
    for name, raw in schema["properties"].items():
        inlined = _inline(raw, definitions)
        entries[name] = {
            "title": inlined.pop("title", name),
            "description": inlined.pop("description", ""),
            "schema": common(inlined),
        }
    return entries, frozenset(schema.get("required", ()))


def _inline(node: Any, definitions: dict[str, Any]) -> Any:
    """Replace every reference by its target, so that each input's schema stands alone. No model is recursive."""
    if isinstance(node, list):
        return [_inline(item, definitions) for item in node]
    if not isinstance(node, dict):
        return node
    merged = dict(node)
    reference = merged.pop("$ref", None)
    if reference is not None:
        merged = {**definitions[reference.rpartition("/")[2]], **merged}
    return {key: _inline(value, definitions) for key, value in merged.items()}
