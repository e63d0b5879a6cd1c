"""For operators of the service: alive, ready, metrics."""

from __future__ import annotations

import logging

from fastapi import APIRouter, Request
from fastapi.responses import Response
from prometheus_client.exposition import CONTENT_TYPE_LATEST

from safestart.errors import Unavailable
from safestart_service.access.gate import caller
from safestart_service.documents.access_schemas import CallerDocument
from safestart_service.documents.openapi import answer, content, refusals
from safestart_service.documents.schemas import Health, Readiness
from safestart_service.http.answers import Json
from safestart_service.http.strict import StrictRoute
from safestart_service.state import services

router = APIRouter(tags=["operations"], route_class=StrictRoute)
log = logging.getLogger("safestart.service")


@router.get(
    "/healthz",
    operation_id="getHealth",
    summary="Alive",
    responses={200: answer(Health, "The process lives."), **refusals()},
)
async def healthz(request: Request) -> Response:
    """The process lives and its event loop turns."""
    return Json({"status": "ok", "version": request.app.version})


@router.get(
    "/readyz",
    operation_id="getReadiness",
    summary="Ready",
    responses={200: answer(Readiness, "The database and a cluster answer."), **refusals(503)},
)
def readyz(request: Request) -> Response:
    """Database and cluster answer, so that jobs are taken; says how many workers, places and jobs there are.

    503 without a worker whose cluster runs: jobs are accepted and wait, and the instant answers go on.
    """
    found = services(request)
    counts, crew = found.jobs.counts(), found.jobs.crew()
    if not crew.places:
        raise Unavailable(
            f"required a worker with a running cluster, found {crew.workers} workers without one",
            required="a worker with a running cluster",
            received=crew.workers,
        )
    return Json(
        {
            "status": "ready",
            "workers_alive": crew.workers,
            "places": crew.places,
            "places_taken": crew.busy,
            "jobs": counts,
        }
    )


@router.get(
    "/caller",
    operation_id="getCaller",
    summary="Who is asking",
    responses={200: answer(CallerDocument, "The caller, as the audit log names it."), **refusals(503)},
)
async def who(request: Request) -> Response:
    """The key of this request by its id and name, and what it may do."""
    by = caller(request)
    return Json(
        {"key_id": by.key_id, "name": by.name, "role": by.role.value}, headers={"Cache-Control": "no-store"}
    )


@router.get(
    "/metrics",
    operation_id="getMetrics",
    summary="Prometheus metrics",
    responses={200: content("text/plain", {"type": "string"}, "Exposition format."), **refusals()},
)
def metrics(request: Request) -> Response:
    """Requests and latency by route, jobs by status, workers alive."""
    return Response(services(request).metrics.render(), media_type=CONTENT_TYPE_LATEST)
