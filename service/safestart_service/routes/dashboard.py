"""The dashboard: pages and their files. Every figure on a page comes from the public API."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import Response

from safestart_service.documents.describe import verdict_words
from safestart_service.documents.openapi import content, refusals
from safestart_service.http.answers import root_path
from safestart_service.pages import render as pages
from safestart_service.routes.jobs import JobId

router = APIRouter(tags=["dashboard"])
_PAGE = content("text/html", {"type": "string"}, "A page.")


@router.get(
    "/dashboard",
    operation_id="getExplorePage",
    summary="Explore the safe-start region",
    responses={200: _PAGE, **refusals()},
)
async def explore(request: Request) -> Response:
    """Operating point, regions, one start and its flight."""
    return pages.page(
        "explore.html", root=root_path(request), here="/dashboard", script="explore.js", plots=True
    )


@router.get(
    "/dashboard/trade",
    operation_id="getTradePage",
    summary="Trade study",
    responses={200: _PAGE, **refusals()},
)
async def trade(request: Request) -> Response:
    """What more thrust buys at each tumble rate."""
    return pages.page(
        "trade.html", root=root_path(request), here="/dashboard/trade", script="trade.js", plots=True
    )


@router.get(
    "/dashboard/submit",
    operation_id="getSubmitPage",
    summary="Submit a process",
    responses={200: _PAGE, **refusals()},
)
async def submit(request: Request) -> Response:
    """A form for each process, made from its schema."""
    return pages.page(
        "submit.html", root=root_path(request), here="/dashboard/submit", script="submit.js", plots=True
    )


@router.get(
    "/dashboard/jobs",
    operation_id="getJobsPage",
    summary="Jobs as a page",
    responses={200: _PAGE, **refusals()},
)
async def jobs(request: Request) -> Response:
    """Jobs with progress, place in the queue, time left and why they wait."""
    return pages.page(
        "jobs.html",
        root=root_path(request),
        here="/dashboard/jobs",
        script="jobs.js",
        plots=False,
        verdicts=verdict_words(),
    )


@router.get(
    "/dashboard/jobs/{jobID}",
    operation_id="getJobPage",
    summary="A job as a page",
    responses={200: _PAGE, **refusals(422)},
)
async def job(request: Request, jobID: JobId) -> Response:
    """Live progress and log, then results, pictures and downloads of one job; unknown ids are told on the page."""
    return pages.page(
        "job.html", root=root_path(request), here="/dashboard/jobs", script="job.js", plots=True, job=jobID
    )


@router.get(
    "/dashboard/compare",
    operation_id="getComparePage",
    summary="Compare runs",
    responses={200: _PAGE, **refusals()},
)
async def compare(request: Request) -> Response:
    """Two or more successful benchmarks side by side: `?jobs=ID,ID`."""
    return pages.page(
        "compare.html", root=root_path(request), here="/dashboard/jobs", script="compare.js", plots=True
    )


@router.get("/static/{name:path}", include_in_schema=False)
async def static(request: Request, name: str) -> Response:
    """Scripts, style sheets and icon of the pages."""
    return pages.static(request, name)
