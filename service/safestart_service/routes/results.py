"""Results and artifacts of ended jobs, with entity tags: they never change."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request
from fastapi.responses import Response

from safestart_service.answers import Json, base_url, entity_tag, not_modified
from safestart_service.jobs_view import known_job, result_document
from safestart_service.openapi import answer, content, refusals
from safestart_service.routes.jobs import JobId
from safestart_service.schemas import ResultDocument
from safestart_service.state import services

router = APIRouter(tags=["results"])

_CACHE = "private, no-cache"
_ETAG = "SHA-256 of the content."
# Types a browser may show; everything else is a download, so that nothing a worker stored can act as a page.
_SHOWN = ("image/png", "image/jpeg", "application/json", "text/csv", "text/plain")


@router.get(
    "/jobs/{jobID}/results",
    summary="Result of a job",
    responses={
        200: answer(ResultDocument, "Inputs, outputs, provenance, artifacts.", ETag=_ETAG),
        **refusals(304, 404, 422, 503),
    },
)
def results(request: Request, jobID: JobId) -> Response:
    """The stored result; 404 ``result-not-ready`` until the job is successful."""
    found = services(request)
    known_job(found, jobID)
    document = result_document(found, jobID, base_url(request))
    tag = entity_tag(document["sha256"])
    return not_modified(request, tag) or Json(document, headers={"ETag": tag, "Cache-Control": _CACHE})


@router.get(
    "/jobs/{jobID}/artifacts/{name}",
    summary="File of a result",
    responses={
        200: content(
            "application/octet-stream", {"type": "string", "format": "binary"}, "The file.", ETag=_ETAG
        ),
        **refusals(304, 404, 422, 503),
    },
)
def artifact(
    request: Request, jobID: JobId, name: Annotated[str, Path(description="Name of the artifact.")]
) -> Response:
    """One file, in its own media type."""
    found = services(request)
    known_job(found, jobID)
    file = found.results.artifact(jobID, name.replace("\0", ""))
    tag = entity_tag(file.sha256)
    place = "inline" if file.media_type in _SHOWN else "attachment"
    safe = "".join(c if c.isascii() and (c.isalnum() or c in "._-") else "_" for c in file.name)
    headers = {
        "ETag": tag,
        "Cache-Control": _CACHE,
        "Content-Disposition": f'{place}; filename="{safe}"',
    }
    return not_modified(request, tag) or Response(file.data, headers=headers, media_type=file.media_type)
