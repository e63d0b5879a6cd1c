"""List, describe and run the processes."""

from __future__ import annotations

from typing import Annotated, Any
from uuid import uuid4

from fastapi import APIRouter, Header, Path, Query, Request
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict, Field

from safestart.processes.base import ProcessSpec
from safestart.processes.registry import PROCESS_IDS, process
from safestart.runtime.access import Caller, Role
from safestart.runtime.progress import Context
from safestart_service.access.gate import caller
from safestart_service.documents.describe import description, known_process, summary
from safestart_service.documents.execution import (
    ExecuteRequest,
    check_outputs,
    check_states,
    execute_model,
    parse_request,
    prefers_async,
    run_now,
    selected,
)
from safestart_service.documents.jobs_view import job_detail
from safestart_service.documents.openapi import TAG, answer, content, json_body, refusals
from safestart_service.documents.schemas import ProcessDescription, ProcessList, Submitted
from safestart_service.errors import Forbidden
from safestart_service.http.answers import Json, base_url, link, tagged, this_url
from safestart_service.http.body import read_body
from safestart_service.http.computing import computed
from safestart_service.http.once import OnceRoute
from safestart_service.state import Services, services

router = APIRouter(tags=["processes"], route_class=OnceRoute)
ProcessId = Annotated[str, Path(description="Id of a process.")]


class ProcessQuery(BaseModel):
    """Paging of the process list."""

    model_config = ConfigDict(extra="forbid")

    limit: int = Field(100, ge=1, le=1000, description="Processes per page.")
    offset: int = Field(0, ge=0, le=10_000, description="How many to skip: taken from the link `next`.")


@router.get(
    "/processes",
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
    summary="Execute a process",
    openapi_extra=json_body(
        {name: execute_model(name) for name in PROCESS_IDS},
        {name: {"inputs": process(name).example} for name in PROCESS_IDS},
    ),
    responses={
        200: content("application/json", {}, "Outputs of a process that ran at once, by name."),
        201: answer(
            Submitted,
            "The job is queued; a benchmark's instant certificate comes with it.",
            Location="The job.",
            Preference_Applied="respond-async, if requested.",
            Idempotency_Replayed="true, if the job existed already.",
        ),
        **refusals(400, 404, 413, 415, 422, 429, 503),
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
    body = await read_body(request)
    # The header's lines form one list; ``prefer`` is only the last line.
    wants_async = prefer is not None and prefers_async(request.headers.getlist("prefer"))
    sync = spec.light and not wants_async
    found, base, by = services(request), base_url(request), caller(request)

    def respond(context: Context) -> Response:
        asked: Any = parse_request(spec.id, body)
        check_outputs(spec, asked, sync=sync)
        check_states(spec, asked.inputs, found.settings.max_states)
        if sync:
            return Json(selected(run_now(spec, asked.inputs, context), asked))
        found.access.require_submit(request)
        return _submit(found, spec, asked, idempotency_key, base, wants_async, by)

    return await computed(request, respond)


def _submit(
    found: Services,
    spec: ProcessSpec,
    asked: ExecuteRequest,
    key: str | None,
    base: str,
    wants_async: bool,
    by: Caller,
) -> Response:
    if asked.priority > 0 and by.key_id is not None and not by.role.allows(Role.ADMIN):
        raise Forbidden(
            f"priority: required at most 0 with a key of role {by.role.value}, received {asked.priority}",
            field="priority",
            required="at most 0, or a key of role admin",
            received=asked.priority,
        )
    instant = spec.instant_answer(asked.inputs)
    new = str(uuid4())
    job = found.jobs.submit(
        spec.id,
        asked.inputs.model_dump(mode="json"),
        instant=instant,
        timeout_s=found.settings.job_timeout_s,
        idempotency_key=key,
        priority=asked.priority,
        max_queued=found.settings.max_queued,
        submitter=by.key_id or "",
        by=by,
        job_id=new,
    )
    document = job_detail(found, job, base)
    if job.instant is not None:
        document["certificate"] = job.instant
    headers = {"Location": f"{base}/jobs/{job.id}"}
    if wants_async:
        headers["Preference-Applied"] = "respond-async"
    if job.id != new:
        headers["Idempotency-Replayed"] = "true"
    return Json(document, 201, headers)
