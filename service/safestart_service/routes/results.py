"""Results and artifacts of ended jobs, with entity tags: they never change."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Path, Query, Request
from fastapi.responses import Response

from safestart_service.documents import formats
from safestart_service.documents.arrays import arrays_of
from safestart_service.documents.jobs_view import known_job, result_document
from safestart_service.documents.openapi import REF, content, refusals
from safestart_service.documents.schemas import ResultDocument
from safestart_service.http.answers import Json, base_url, entity_tag, not_modified
from safestart_service.http.negotiation import chosen
from safestart_service.http.once import OnceRoute
from safestart_service.routes.jobs import JobId
from safestart_service.state import services

router = APIRouter(tags=["results"], route_class=OnceRoute)

_CACHE = "private, no-cache"
_ETAG = "SHA-256 of the content."
_FILE: dict[str, Any] = {"type": "string", "format": "binary"}
Format = Literal["record", "ogc", "csv", "npz", "parquet"]
# Types a browser may show; everything else is a download, so that nothing a worker stored can act as a page.
_SHOWN = ("image/png", "image/jpeg", "application/json", "text/csv", "text/plain")


@router.get(
    "/jobs/{jobID}/results",
    summary="Result of a job",
    responses={
        200: {
            "description": "By Accept: the record (for whoever takes anything), outputs by id as OGC API - Processes "
            "1.0 has them (application/json), or a table or arrays of the outputs.",
            "headers": {"ETag": {"description": _ETAG, "schema": {"type": "string"}}},
            "content": {
                formats.RECORD: {"schema": {"$ref": REF + ResultDocument.__name__}},
                formats.OGC: {"schema": {"type": "object"}},
                **{kind: {"schema": _FILE} for kind in (formats.CSV, formats.NPZ, formats.PARQUET)},
            },
        },
        **refusals(304, 404, 406, 422, 503),
    },
)
def results(
    request: Request,
    jobID: JobId,
    format: Annotated[
        Format | None, Query(description="Instead of Accept, for links: record, ogc, csv, npz or parquet.")
    ] = None,
    table: Annotated[
        str | None,
        Query(max_length=100, description="Which table of the outputs (csv, parquet); absent: the first."),
    ] = None,
) -> Response:
    """The stored result; 404 ``result-not-ready`` until the job is successful."""
    kind = formats.BY_NAME[format] if format else chosen(request.headers.get("accept"), formats.OFFERED)
    found = services(request)
    known_job(found, jobID)
    record = result_document(found, jobID, base_url(request))
    tag = entity_tag(record["sha256"] + formats.tag_of(kind, table))
    known = not_modified(request, tag)
    if known is not None:
        known.headers["Vary"] = "Accept"
        return known
    headers = {"ETag": tag, "Cache-Control": _CACHE, "Vary": "Accept"}
    if kind not in formats.JSON:
        ending = formats.NAME[kind]
        headers["Content-Disposition"] = f'attachment; filename="{jobID}.{ending}"'
    return Response(formats.encoded(record, kind, table), headers=headers, media_type=kind)


@router.get(
    "/jobs/{jobID}/artifacts/{name}",
    summary="File of a result",
    responses={
        200: content("*/*", {"type": "string", "format": "binary"}, "The file, in its own type.", ETag=_ETAG),
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


@router.get(
    "/jobs/{jobID}/artifacts/{name}/arrays",
    summary="Arrays of an NPZ file as JSON",
    responses={
        200: content("application/json", {"type": "object"}, "Arrays by name, nested lists.", ETag=_ETAG),
        **refusals(304, 404, 422, 503),
    },
)
def arrays(
    request: Request,
    jobID: JobId,
    name: Annotated[str, Path(description="Name of an NPZ artifact.")],
    names: Annotated[
        str | None, Query(max_length=1000, description="Only these, separated by commas; absent: all.")
    ] = None,
) -> Response:
    """For readers without NumPy. NaN and infinity become null; at most a million numbers."""
    found = services(request)
    known_job(found, jobID)
    file = found.results.artifact(jobID, name.replace("\0", ""))
    tag = entity_tag(f"{file.sha256}-arrays")
    headers = {"ETag": tag, "Cache-Control": _CACHE}
    return not_modified(request, tag) or Json(arrays_of(file, names), headers=headers)
