"""The dashboard: pages and their files. Every figure on a page comes from the public API."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import Response

from safestart_service.documents.describe import verdict_words
from safestart_service.documents.openapi import content, refusals
from safestart_service.http.answers import root_path
from safestart_service.pages import render as pages
from safestart_service.routes.jobs import JobId

router = APIRouter(tags=["dashboard"])
_PAGE = content("text/html", {"type": "string"}, "A page.")


def _page(request: Request, name: str, here: str, *, plots: bool = True, **values: Any) -> Response:
    """The shell of this name with its script; ``here`` is the entry of the menu it belongs to."""
    return pages.page(
        f"{name}.html", root=root_path(request), here=here, script=f"{name}.js", plots=plots, **values
    )


@router.get(
    "/dashboard",
    operation_id="getExplorePage",
    summary="Explore the safe-start region",
    responses={200: _PAGE, **refusals()},
)
async def explore(request: Request) -> Response:
    """Operating point, regions, one start and its flight."""
    return _page(request, "explore", "/dashboard")


@router.get(
    "/dashboard/space",
    operation_id="getSpacePage",
    summary="Explore in space",
    responses={200: _PAGE, **refusals()},
)
async def space(request: Request) -> Response:
    """Any start, tumble, orbit, corridor and thrust: verdict and proof, slices of the region, the flight in a scene."""
    return _page(request, "space", "/dashboard/space")


@router.get(
    "/dashboard/trade",
    operation_id="getTradePage",
    summary="Trade study",
    responses={200: _PAGE, **refusals()},
)
async def trade(request: Request) -> Response:
    """What more thrust buys at each tumble rate."""
    return _page(request, "trade", "/dashboard/trade")


@router.get(
    "/dashboard/approach",
    operation_id="getApproachPage",
    summary="Approach designer",
    responses={200: _PAGE, **refusals()},
)
async def approach(request: Request) -> Response:
    """Hops along a line that is dragged, what is proved of them, and the study of the same approach."""
    return _page(request, "approach", "/dashboard/approach", plan="hop-plan", study="hopping")


@router.get(
    "/dashboard/submit",
    operation_id="getSubmitPage",
    summary="Submit a process",
    responses={200: _PAGE, **refusals()},
)
async def submit(request: Request) -> Response:
    """A form for each process, made from its schema."""
    return _page(request, "submit", "/dashboard/submit")


@router.get(
    "/dashboard/jobs",
    operation_id="getJobsPage",
    summary="Jobs as a page",
    responses={200: _PAGE, **refusals()},
)
async def jobs(request: Request) -> Response:
    """Jobs with progress, place in the queue, time left and why they wait."""
    return _page(request, "jobs", "/dashboard/jobs", plots=False, verdicts=verdict_words())


@router.get(
    "/dashboard/jobs/{jobID}",
    operation_id="getJobPage",
    summary="A job as a page",
    responses={200: _PAGE, **refusals(422)},
)
async def job(request: Request, jobID: JobId) -> Response:
    """Live progress and log, then results, pictures and downloads of one job; the page says when the id is unknown."""
    return _page(request, "job", "/dashboard/jobs", job=jobID)


@router.get(
    "/dashboard/compare",
    operation_id="getComparePage",
    summary="Compare runs",
    responses={200: _PAGE, **refusals()},
)
async def compare(request: Request) -> Response:
    """Two or more successful benchmarks side by side: `?jobs=ID,ID`."""
    return _page(request, "compare", "/dashboard/jobs")


@router.get("/static/{name:path}", include_in_schema=False)
async def static(request: Request, name: str) -> Response:
    """Scripts, style sheets and icon of the pages."""
    return pages.static(request, name)
