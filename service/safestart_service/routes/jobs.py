"""Jobs: list, status, dismissal."""

from __future__ import annotations

from typing import Annotated
from urllib.parse import urlencode

from fastapi import APIRouter, Path, Query, Request
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict, Field

from safestart.errors import invalid
from safestart.processes.registry import PROCESS_IDS
from safestart.store.records import JobStatus
from safestart_service.answers import Json, base_url, link
from safestart_service.jobs_view import job_detail, known_job, status_info
from safestart_service.openapi import answer, refusals
from safestart_service.schemas import JobDetail, JobList
from safestart_service.state import services

router = APIRouter(tags=["jobs"])
JobId = Annotated[str, Path(description="Id of a job.")]


class JobQuery(BaseModel):
    """Filters and paging of the job list."""

    model_config = ConfigDict(extra="forbid", populate_by_name=True)

    status: list[JobStatus] = Field([], max_length=5, description="Only jobs of these statuses.")
    processID: list[str] = Field([], max_length=50, description="Only jobs of these processes.")
    limit: int = Field(50, ge=1, le=200, description="Jobs per page.")
    cursor: str | None = Field(
        None, max_length=200, description="Where to go on: taken from the link `next`."
    )


@router.get(
    "/jobs", summary="List of jobs", responses={200: answer(JobList, "A page of jobs."), **refusals(422, 503)}
)
def jobs(request: Request, query: Annotated[JobQuery, Query()]) -> Response:
    """Jobs, newest first; the link `next` leads to the next page."""
    for name in query.processID:
        if name not in PROCESS_IDS:
            raise invalid("processID", f"one of {', '.join(PROCESS_IDS)}", name)
    found, base = services(request), base_url(request)
    page = found.jobs.list(
        statuses=query.status, process_ids=query.processID, limit=query.limit, cursor=query.cursor
    )
    workers = found.jobs.workers_alive()
    links = [link(f"{base}/jobs", "self", "this list")]
    if page.next_cursor is not None:
        again = query.model_dump(mode="json", exclude_defaults=True) | {"cursor": page.next_cursor}
        links.append(link(f"{base}/jobs?{urlencode(again, doseq=True)}", "next", "next page"))
    return Json({"jobs": [status_info(found, job, base, workers) for job in page.jobs], "links": links})


@router.get(
    "/jobs/{jobID}",
    summary="Status of a job",
    responses={200: answer(JobDetail, "statusInfo."), **refusals(404, 422, 503)},
)
def job(request: Request, jobID: JobId) -> Response:
    """Status with progress, place in the queue and why it waits, estimated time left."""
    found = services(request)
    return Json(job_detail(found, known_job(found, jobID), base_url(request)))


@router.delete(
    "/jobs/{jobID}",
    summary="Dismiss a job",
    responses={200: answer(JobDetail, "statusInfo after the dismissal."), **refusals(404, 409, 422, 503)},
)
def dismiss(request: Request, jobID: JobId) -> Response:
    """Dismiss a waiting job at once; a running one is asked to stop, and stops soon."""
    found = services(request)
    known_job(found, jobID)
    return Json(job_detail(found, found.jobs.dismiss(jobID), base_url(request)))
