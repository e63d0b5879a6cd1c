"""The dashboard: jobs as pages."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response

from safestart.store.records import JobStatus
from safestart_service import pages
from safestart_service.jobs_view import job_detail, known_job, result_document, status_info
from safestart_service.openapi import content, refusals
from safestart_service.routes.jobs import JobId
from safestart_service.state import services

router = APIRouter(tags=["dashboard"])

_PAGE = content("text/html", {"type": "string"}, "A page.")


@router.get("/dashboard", summary="Jobs as a page", responses={200: _PAGE, **refusals(422, 503)})
def dashboard(
    request: Request, cursor: Annotated[str | None, Query(max_length=200, description="Next page.")] = None
) -> Response:
    """Jobs with status, progress, place in the queue and time left; reloads itself while something runs."""
    found = services(request)
    page = found.jobs.list(limit=25, cursor=cursor)
    workers = found.jobs.workers_alive()
    root = request.scope.get("root_path", "")
    jobs = [status_info(found, job, root, workers) for job in page.jobs]
    return pages.job_list(jobs, found.jobs.counts(), workers, page.next_cursor, root)


@router.get(
    "/dashboard/jobs/{jobID}", summary="A job as a page", responses={200: _PAGE, **refusals(404, 422, 503)}
)
def dashboard_job(request: Request, jobID: JobId) -> Response:
    """Status, inputs, instant certificate, results and pictures of one job."""
    found = services(request)
    job = known_job(found, jobID)
    root = request.scope.get("root_path", "")
    result = result_document(found, jobID, root) if job.status is JobStatus.SUCCESSFUL else None
    return pages.job(job_detail(found, job, root), result, root)


@router.get("/static/{name}", include_in_schema=False)
async def static(name: str) -> Response:
    """Our style sheet and icon."""
    return pages.static(name)
