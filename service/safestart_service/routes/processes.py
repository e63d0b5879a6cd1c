"""What there is to run, and running it."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Request
from fastapi.responses import Response

from safestart.access import Caller, Role
from safestart.processes.base import ProcessSpec
from safestart.processes.registry import PROCESS_IDS, process
from safestart_service.access import caller
from safestart_service.answers import Json, base_url, link, tagged
from safestart_service.body import parse_body, read_body
from safestart_service.describe import description, known_process, summary
from safestart_service.errors import Forbidden
from safestart_service.execute import (
    ExecuteRequest,
    check_outputs,
    check_states,
    execute_model,
    prefers_async,
    run_now,
    selected,
)
from safestart_service.jobs_view import job_detail
from safestart_service.openapi import TAG, answer, content, json_body, refusals
from safestart_service.schemas import ProcessDescription, ProcessList, Submitted
from safestart_service.state import Services, services

router = APIRouter(tags=["processes"])
ProcessId = Annotated[str, Path(description="Id of a process.")]


@router.get(
    "/processes",
    summary="List of processes",
    responses={200: answer(ProcessList, "All.", ETag=TAG), **refusals(304)},
)
async def processes(request: Request) -> Response:
    """Everything that can be run."""
    base = base_url(request)
    entries = [summary(process(name), base) for name in PROCESS_IDS]
    return tagged(request, {"processes": entries, "links": [link(f"{base}/processes", "self", "this list")]})


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
            Preference_Applied="respond-async, when that was asked for.",
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
    wants_async = prefers_async(prefer)
    sync = spec.light and not wants_async
    found, base, by = services(request), base_url(request), caller(request)

    def respond() -> Response:
        asked: Any = parse_body(execute_model(spec.id), body)
        check_outputs(spec, asked, sync=sync)
        check_states(asked.inputs, found.settings.max_states)
        if sync:
            return Json(selected(run_now(spec, asked.inputs, found.context), asked))
        found.access.require_submit(request)
        return _submit(found, spec, asked, idempotency_key, base, wants_async, by)

    return await asyncio.to_thread(respond)


def _submit(
    found: Services,
    spec: ProcessSpec,
    asked: ExecuteRequest | Any,
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
    )
    document = job_detail(found, job, base)
    if job.instant is not None:
        document["certificate"] = job.instant
    headers = {"Location": f"{base}/jobs/{job.id}"}
    if wants_async:
        headers["Preference-Applied"] = "respond-async"
    return Json(document, 201, headers)
