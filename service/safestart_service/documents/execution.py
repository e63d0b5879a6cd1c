"""Execution requests of OGC API - Processes 1.0: their models, the choice of mode, the selection of outputs."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import Any, Literal

import orjson
from pydantic import Field, create_model

from safestart.errors import InvalidInput, invalid
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.registry import process
from safestart.records.labels import NAME_TEXT, NOTE_TEXT, TAGS_TEXT, Labels, Name, Note, Tags
from safestart_service.documents.describe import output_ids
from safestart_service.documents.formats.ogc import ogc_members
from safestart_service.http.body import MOST_PARTS, parse_body, require_bounded, require_once

_QUALIFIED = {"value", "mediaType", "encoding", "schema"}


class OutputFormat(WireModel):
    """The format of one output; a whole result has others, by Accept."""

    mediaType: Literal["application/json"] = "application/json"
    encoding: Literal["UTF-8", "utf-8"] = "UTF-8"


class OutputRequest(WireModel):
    """How one output is wanted; JSON values only."""

    transmissionMode: Literal["value"] = "value"
    format: OutputFormat = Field(default_factory=OutputFormat)


class ExecuteRequest(WireModel):
    """The common part of execution requests. Each process has its own subclass with typed ``inputs``."""

    priority: int = Field(
        0,
        ge=-100,
        le=100,
        description="Of a queued job: higher is served first. Above 0 only with an admin key.",
    )
    name: Name = Field("", description=f"Of a queued job. {NAME_TEXT}")
    tags: Tags = Field(default_factory=list, description=f"Of a queued job. {TAGS_TEXT}")
    note: Note = Field("", description=f"Of a queued job. {NOTE_TEXT}")
    outputs: dict[str, OutputRequest] | None = Field(
        None, description="Outputs wanted; absent: all. A stored result always holds all of them."
    )
    response: Literal["document", "raw"] = Field(
        "document", description="raw (the bare value) needs exactly one entry in outputs, and sync execution."
    )
    inputs: Any

    def labels(self) -> Labels:
        """Name, tags and note of the job."""
        return Labels(name=self.name, tags=self.tags, note=self.note)


@cache
def execute_model(process_id: str) -> type[ExecuteRequest]:
    """The execution request of one process."""
    spec = process(process_id)
    name = "Execute" + process_id.title().replace("-", "")
    inputs: Any = (spec.inputs, Field(description="Inputs of the process."))
    return create_model(
        name, __base__=ExecuteRequest, __doc__=f"Execution request of {process_id}.", inputs=inputs
    )


def parse_request(process_id: str, body: bytes, most_parts: int = MOST_PARTS) -> ExecuteRequest:
    """Validate a body; raises as :func:`parse_body`.

    An input may be a qualified value, ``{"value": ...}``, which the standard uses for objects; this is tried only
    when the body is otherwise invalid.
    """
    model = execute_model(process_id)
    # Here, too: what is refused for its size is not read again to look for qualified values.
    require_bounded(body, most_parts)
    try:
        return parse_body(model, body, most_parts)
    except InvalidInput:
        plain = _unqualified(body)
        if plain is None:
            raise
        return parse_body(model, plain, most_parts)


def _unqualified(body: bytes) -> bytes | None:
    """The body with bare values for qualified ones; None when it has no qualified value."""
    try:
        document = orjson.loads(body)
        inputs = document["inputs"].items()
    except (ValueError, TypeError, KeyError, AttributeError):
        return None
    bare = {name: value["value"] for name, value in inputs if _is_qualified(value)}
    if bare:
        require_once(body)  # before a new document repeats each name only once
    return orjson.dumps(document | {"inputs": document["inputs"] | bare}) if bare else None


def _is_qualified(value: Any) -> bool:
    return isinstance(value, dict) and "value" in value and set(value) <= _QUALIFIED


def check_outputs(spec: ProcessSpec, request: ExecuteRequest, *, sync: bool) -> None:
    """Raise ``InvalidInput`` for unknown outputs and for an impossible raw response."""
    known = output_ids(spec)
    for name in request.outputs or ():
        if name not in known:
            raise invalid("outputs", f"names among {', '.join(known)}", name)
    if request.response == "raw" and not (sync and request.outputs is not None and len(request.outputs) == 1):
        raise invalid(
            "response", "document, or raw with sync execution and exactly one entry in outputs", "raw"
        )


def check_states(spec: ProcessSpec, inputs: WireModel, max_states: int) -> None:
    """Raise ``InvalidInput`` for more states than the service's settings allow."""
    if spec.states and len(getattr(inputs, spec.states)) > max_states:
        raise invalid(spec.states, f"at most {max_states} items", len(getattr(inputs, spec.states)))


def selected(parts: Iterable[tuple[str, Any]], request: ExecuteRequest) -> Any:
    """Of the outputs those that are requested.

    As members of the standard's results document, one after the other, or the bare value of a raw response.
    """
    if request.outputs is not None:
        document = dict(parts)
        parts = [(name, document[name]) for name in request.outputs]
    return next(iter(parts))[1] if request.response == "raw" else ogc_members(parts)


def prefers_async(headers: Iterable[str]) -> bool:
    """True when a Prefer header (RFC 7240) asks for ``respond-async``."""
    preferences = (preference.partition(";")[0] for header in headers for preference in header.split(","))
    return any(preference.strip().lower() == "respond-async" for preference in preferences)
