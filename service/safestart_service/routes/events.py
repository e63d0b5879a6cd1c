"""Follow a job."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Header, Request
from fastapi.responses import Response
from starlette.concurrency import run_in_threadpool

from safestart_service.documents.jobs_view import known_job
from safestart_service.documents.openapi import content, refusals
from safestart_service.http.following import Followed
from safestart_service.http.sse import resume_point, stream
from safestart_service.http.strict import StrictRoute
from safestart_service.routes.jobs import JobId
from safestart_service.state import services

router = APIRouter(tags=["jobs"], route_class=StrictRoute)


@router.get(
    "/jobs/{jobID}/events",
    operation_id="getEvents",
    summary="Events of a job",
    responses={
        200: content("text/event-stream", {}, "status, progress and log events, with ids."),
        204: {"description": "The job has ended and nothing came after Last-Event-ID: do not reconnect."},
        **refusals(404, 422, 503),
    },
)
async def events(
    request: Request,
    jobID: JobId,
    last_event_id: Annotated[str | None, Header(description="Continue after this event.")] = None,
) -> Response:
    """Server-sent events until the job has ended; ``Last-Event-ID`` resumes where a stream broke off."""
    found = services(request)
    after = resume_point(last_event_id)
    job = await run_in_threadpool(known_job, found, jobID)
    if after:  # an id that is not an event of this job says nothing about what the client has seen
        known = await run_in_threadpool(found.jobs.events, jobID, after - 1, 1)
        after = after if known and known[0].id == after else 0
    if after and job.status.ended and not await run_in_threadpool(found.jobs.events, jobID, after, 1):
        return Response(status_code=204)
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    events_of = stream(request, jobID, after)
    return Followed(found.following, request, events_of, media_type="text/event-stream", headers=headers)
