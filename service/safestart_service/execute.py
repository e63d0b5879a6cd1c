"""Execution requests of OGC API - Processes 1.0: their models, the choice of mode, the selection of outputs."""

from __future__ import annotations

from functools import cache
from typing import Any, Literal

from pydantic import Field, create_model

from safestart.errors import invalid
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.processes.registry import process
from safestart.progress import Context
from safestart_service.describe import output_ids


class OutputRequest(WireModel):
    """How one output is wanted; values only."""

    transmissionMode: Literal["value"] = "value"


class ExecuteRequest(WireModel):
    """What all execution requests share. Each process has its own subclass with typed ``inputs``."""

    priority: int = Field(
        0,
        ge=-100,
        le=100,
        description="Of a queued job: higher is served first. Above 0 only with an admin key.",
    )
    outputs: dict[str, OutputRequest] | None = Field(
        None, description="Outputs wanted; absent: all. A stored result always holds all of them."
    )
    response: Literal["document", "raw"] = Field(
        "document", description="raw (the bare value) needs exactly one entry in outputs, and sync execution."
    )


@cache
def execute_model(process_id: str) -> type[ExecuteRequest]:
    """The execution request of one process."""
    spec = process(process_id)
    name = "Execute" + process_id.title().replace("-", "")
    inputs: Any = (spec.inputs, Field(description="Inputs of the process."))
    return create_model(
        name, __base__=ExecuteRequest, __doc__=f"Execution request of {process_id}.", inputs=inputs
    )


def check_outputs(spec: ProcessSpec, request: ExecuteRequest, *, sync: bool) -> None:
    """Raise ``InvalidInput`` for outputs the process has not, and for a raw response that cannot be given."""
    known = output_ids(spec)
    for name in request.outputs or ():
        if name not in known:
            raise invalid("outputs", f"names among {', '.join(known)}", name)
    if request.response == "raw" and not (sync and request.outputs is not None and len(request.outputs) == 1):
        raise invalid(
            "response", "document, or raw with sync execution and exactly one entry in outputs", "raw"
        )


def check_states(inputs: WireModel, max_states: int) -> None:
    """Raise ``InvalidInput`` beyond the number of states that this service is set to take."""
    if isinstance(inputs, GoNoGoInputs) and len(inputs.states) > max_states:
        raise invalid("states", f"at most {max_states} items", len(inputs.states))


def run_now(spec: ProcessSpec, inputs: WireModel, context: Context) -> dict[str, Any]:
    """Run a light process here; returns its output document."""
    return spec.runner()(inputs, context).document


def selected(document: dict[str, Any], request: ExecuteRequest) -> Any:
    """The outputs asked for, or the bare value of a raw response."""
    if request.outputs is None:
        return document
    chosen = {name: document[name] for name in request.outputs}
    return next(iter(chosen.values())) if request.response == "raw" else chosen


def prefers_async(header: str | None) -> bool:
    """True when a Prefer header (RFC 7240) asks for ``respond-async``."""
    preferences = (header or "").replace(";", ",").split(",")
    return any(preference.strip().lower() == "respond-async" for preference in preferences)
