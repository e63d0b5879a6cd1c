"""List, describe and run the processes."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Header, Path, Query, Request
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict, Field

from safestart.processes.registry import PROCESS_IDS, process
from safestart_service.computing.dispatch import posted
from safestart_service.computing.light import Left
from safestart_service.documents.describe import description, known_process, summary
from safestart_service.documents.estimate import Estimate, estimate
from safestart_service.documents.execution import (
    execute_model,
    parse_request,
    prefers_async,
)
from safestart_service.documents.openapi import TAG, answer, content, json_body, refusals
from safestart_service.documents.schemas import ProcessDescription, ProcessList, Submitted
from safestart_service.http.answers import Json, base_url, link, tagged, this_url
from safestart_service.http.body import MOST_PARTS, PARTS_PER_STATE, read_body
from safestart_service.http.strict import StrictRoute
from safestart_service.state import services

router = APIRouter(tags=["processes"], route_class=StrictRoute)
_REQUEST = json_body(
    {name: execute_model(name) for name in PROCESS_IDS},
    {name: {"inputs": process(name).example} for name in PROCESS_IDS},
    "ExecuteRequest",
)
"""The body of an execution and of an estimate."""
ProcessId = Annotated[str, Path(description="Id of a process.")]


class ProcessQuery(BaseModel):
    """Paging of the process list."""

    model_config = ConfigDict(extra="forbid")

    limit: int = Field(100, ge=1, le=1000, description="Processes per page.")
    offset: int = Field(0, ge=0, le=10_000, description="How many to skip: taken from the link `next`.")


@router.get(
    "/processes",
    operation_id="getProcesses",
    summary="List of processes",
    responses={200: answer(ProcessList, "A page of processes.", ETag=TAG), **refusals(304, 422)},
)
async def processes(request: Request, query: Annotated[ProcessQuery, Query()]) -> Response:
    """Everything that can be run; the links `next` and `prev` lead to the pages beside it."""
    base, end = base_url(request), query.offset + query.limit
    links = [link(this_url(request), "self", "this list")]
    if end < len(PROCESS_IDS):
        further = f"{base}/processes?limit={query.limit}&offset={end}"
        links.append(link(further, "next", "next page"))
    if query.offset:
        before = f"{base}/processes?limit={query.limit}&offset={max(0, query.offset - query.limit)}"
        links.append(link(before, "prev", "previous page"))
    entries = [summary(process(name), base) for name in PROCESS_IDS[query.offset : end]]
    return tagged(request, {"processes": entries, "links": links})


@router.get(
    "/processes/{processID}",
    operation_id="getProcessDescription",
    summary="Description of a process",
    responses={
        200: answer(ProcessDescription, "Inputs and outputs as JSON schemas.", ETag=TAG),
        **refusals(304, 404),
    },
)
async def describe(request: Request, processID: ProcessId) -> Response:
    """Inputs and outputs of one process, as JSON schemas that stand alone."""
    return tagged(request, description(known_process(processID), base_url(request)))


@router.post(
    "/processes/{processID}/execution",
    operation_id="execute",
    summary="Execute a process",
    openapi_extra=_REQUEST,
    responses={
        200: content("application/json", {}, "Outputs of a process that ran at once, by name."),
        201: answer(
            Submitted,
            "The job is queued; a benchmark's instant certificate comes with it.",
            Location="The job.",
            Preference_Applied="respond-async, if requested.",
            Idempotency_Replayed="true, if the job existed already.",
        ),
        **refusals(400, 404, 413, 415, 422, 429, 503, 504),
    },
)
async def execute(
    request: Request,
    processID: ProcessId,
    prefer: Annotated[str | None, Header(description="respond-async: queue a light process too.")] = None,
    idempotency_key: Annotated[
        str | None, Header(description="1 to 255 characters; the same key and body return the same job.")
    ] = None,
) -> Response:
    """Light processes answer at once (200); with ``Prefer: respond-async`` they are queued, as heavy ones are."""
    spec = known_process(processID)
    # The header's lines form one list; ``prefer`` is only the last line.
    wants_async = prefer is not None and prefers_async(request.headers.getlist("prefer"))
    return await posted(
        request,
        spec.id,
        queued=wants_async or not spec.light,
        wants_async=wants_async,
        idempotency_key=idempotency_key,
    )


@router.post(
    "/processes/{processID}/estimate",
    operation_id="estimate",
    summary="How long a run would take",
    openapi_extra=_REQUEST,
    responses={
        200: answer(Estimate, "The estimate, and what it is known from."),
        **refusals(400, 404, 413, 415, 422, 429, 503),
    },
)
async def estimated(request: Request, processID: ProcessId) -> Response:
    """Takes the request of an execution and runs nothing; the time counts from the start of the run."""
    spec, body = known_process(processID), await read_body(request)
    found = services(request)

    def work(left: Left) -> Response:
        del left  # short
        parts = MOST_PARTS + (PARTS_PER_STATE * found.settings.max_states if spec.states else 0)
        inputs = parse_request(spec.id, body, parts).inputs
        past = found.jobs.durations(spec.id, inputs.model_dump(mode="json"))
        return Json(estimate(spec, inputs, past))

    return await found.submitting(request, work)
