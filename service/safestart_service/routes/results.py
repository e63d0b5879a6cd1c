"""Results and artifacts of ended jobs, with entity tags: they never change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from fastapi import APIRouter, Path, Query, Request
from fastapi.responses import Response

from safestart.errors import Conflict
from safestart.processes.tables.foreign import fit_for
from safestart_service.computing.light import Left
from safestart_service.documents.arrays import arrays_of
from safestart_service.documents.formats.base import Format
from safestart_service.documents.formats.registry import BY_NAME, BY_TYPE, FORMATS, tag_of
from safestart_service.documents.jobs_view import known_job, result_document
from safestart_service.documents.openapi import REF, content, refusals
from safestart_service.http.answers import Json, all_lines, base_url, entity_tag, not_modified
from safestart_service.http.negotiation import chosen
from safestart_service.http.strict import StrictRoute
from safestart_service.routes.jobs import JobId
from safestart_service.state import services

router = APIRouter(tags=["results"], route_class=StrictRoute)


def _body(form: Format) -> dict[str, Any]:
    """A format's entry in the API description."""
    if form.model is not None:
        return {"schema": {"$ref": REF + form.model.__name__}}
    return {"schema": {"type": "object"} if form.document else _FILE}


_CACHE = "private, no-cache"
_ETAG = "SHA-256 of the content."
MOST_BUNDLED = 64 * 1024**2
"""Bytes of the files in a bundle that the service packs; it is in memory while it is packed."""
_FILE: dict[str, Any] = {"type": "string", "format": "binary"}
_NAMES = list(BY_NAME)
_WITH_ROWS = [form.name for form in FORMATS if form.rows]
if TYPE_CHECKING:
    FormatName = str
else:
    FormatName = Literal[tuple(_NAMES)]
# Types that a browser may show. Everything else is a download, so that no stored file can act as a page.
_SHOWN = ("image/png", "image/jpeg", "application/json", "text/csv", "text/plain")


@router.get(
    "/jobs/{jobID}/results",
    operation_id="getResult",
    summary="Result of a job",
    responses={
        200: {
            "description": "By Accept: the record (if the client accepts anything), outputs by id as in OGC API - "
            "Processes 1.0 (application/json), or a table or arrays of the outputs.",
            "headers": {"ETag": {"description": _ETAG, "schema": {"type": "string"}}},
            "content": {form.media_type: _body(form) for form in FORMATS},
        },
        **refusals(304, 404, 406, 422, 503),
    },
)
def results(
    request: Request,
    jobID: JobId,
    format: Annotated[
        FormatName | None,
        Query(description=f"Instead of Accept, for links: {', '.join(_NAMES[:-1])} or {_NAMES[-1]}."),
    ] = None,
    table: Annotated[
        str | None,
        Query(
            max_length=100,
            description=f"Which table of the outputs ({', '.join(_WITH_ROWS)}); absent: the first.",
        ),
    ] = None,
) -> Response:
    """The stored result; 404 ``result-not-ready`` until the job is successful."""
    form = BY_NAME[format] if format else BY_TYPE[chosen(all_lines(request, "accept"), list(BY_TYPE))]
    found = services(request)
    known_job(found, jobID)
    record = result_document(found, jobID, base_url(request))
    tag = entity_tag(record["sha256"] + tag_of(form, table))
    known = not_modified(request, tag)
    if known is not None:
        known.headers["Vary"] = "Accept"
        return known
    headers = {"ETag": tag, "Cache-Control": _CACHE, "Vary": "Accept"}
    if not form.document:
        headers["Content-Disposition"] = f'attachment; filename="{jobID}.{form.name}"'
    data = fit_for(record, lambda: form.encode(record, table))
    return Response(data, headers=headers, media_type=form.media_type)


@router.get(
    "/jobs/{jobID}/artifacts/{name}",
    operation_id="getArtifact",
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
    operation_id="getArtifactArrays",
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


@router.get(
    "/jobs/{jobID}/bundle",
    operation_id="getBundle",
    summary="A job as one file",
    responses={
        200: content(
            "application/zip",
            {"type": "string", "format": "binary"},
            "Result, files, events and a page that opens without a server.",
            Safestart_Seal="SHA-256 of its manifest, the seal: keep it apart from the bundle.",
        ),
        **refusals(404, 409, 422, 429, 503),
    },
)
async def bundle(
    request: Request,
    jobID: JobId,
    form: Annotated[
        Literal["bundle", "ro-crate"],
        Query(
            alias="format", description="ro-crate: with JSON-LD for repositories of research data, unsealed."
        ),
    ] = "bundle",
) -> Response:
    """As `safestart export` writes it, of a job that has ended; with files of more than 64 MiB only that writes it."""
    found = services(request)

    def work(left: Left) -> Response:
        del left
        from safestart.records.bundle import pack
        from safestart.records.crate import pack_crate
        from safestart.store.transfer import Transfer

        known_job(found, jobID)
        size = sum(file.size for file in found.results.artifacts(jobID))
        if size > MOST_BUNDLED:
            raise Conflict(
                f"the files of job {jobID} have {size} bytes; required at most {MOST_BUNDLED}; "
                "`safestart export` writes any bundle",
                field="jobID",
                required=f"files of at most {MOST_BUNDLED} bytes",
                received=size,
            )
        kept = Transfer(found.database).read(jobID)
        if form == "ro-crate":
            told = {
                "Content-Disposition": f'attachment; filename="{jobID}.crate.zip"',
                "Cache-Control": _CACHE,
            }
            return Response(pack_crate(kept), headers=told, media_type="application/zip")
        data, seal = pack(kept)
        name = f'attachment; filename="{jobID}.zip"'
        headers = {"Content-Disposition": name, "Safestart-Seal": seal, "Cache-Control": _CACHE}
        return Response(data, headers=headers, media_type="application/zip")

    return await found.packing(request, work)
