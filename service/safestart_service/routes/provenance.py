"""Provenance of jobs: OGC API - Processes Part 4 (draft), class Provenance."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import Response

from safestart.processes.registry import PROCESS_IDS, process
from safestart.store.records import JobStatus
from safestart_service.documents.describe import output_ids
from safestart_service.documents.jobs_view import known_job, result_document
from safestart_service.documents.openapi import TAG, answer, content, refusals
from safestart_service.documents.prov import provenance
from safestart_service.documents.schemas import JobInputs
from safestart_service.http.answers import base_url, tagged
from safestart_service.http.strict import StrictRoute
from safestart_service.routes.jobs import JobId
from safestart_service.state import services

router = APIRouter(tags=["provenance"], route_class=StrictRoute)


@router.get(
    "/jobs/{jobID}/inputs",
    operation_id="getJobInputs",
    summary="Inputs of a job",
    responses={
        200: answer(JobInputs, "With every default filled in.", ETag=TAG),
        **refusals(304, 404, 422, 503),
    },
)
def inputs(request: Request, jobID: JobId) -> Response:
    """The inputs that the job computes, and the outputs that its result holds."""
    job = known_job(services(request), jobID)
    known = output_ids(process(job.process_id)) if job.process_id in PROCESS_IDS else ()
    outputs: dict[str, object] = {name: {} for name in known}
    return tagged(request, {"inputs": job.inputs, "outputs": outputs})


@router.get(
    "/jobs/{jobID}/prov",
    operation_id="getProvenance",
    summary="Provenance of a job",
    responses={
        200: content("application/json", {"type": "object"}, "PROV-JSON.", ETag=TAG),
        **refusals(304, 404, 422, 503),
    },
)
def prov(request: Request, jobID: JobId) -> Response:
    """Inputs, process, software and files of a job, as PROV-JSON (W3C); the result and its files once there are any."""
    found, base = services(request), base_url(request)
    job = known_job(found, jobID)
    record = result_document(found, jobID, base) if job.status is JobStatus.SUCCESSFUL else None
    return tagged(request, provenance(job, record, base))
