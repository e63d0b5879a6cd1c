"""Jobs: list, status, labels, dismissal."""

from __future__ import annotations

from collections.abc import Iterator
from time import monotonic
from typing import Annotated, Any, Literal
from urllib.parse import urlencode

from fastapi import APIRouter, Path, Query, Request
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from safestart.errors import invalid
from safestart.processes.registry import PROCESS_IDS
from safestart.store.jobs.filters import JobFilter, Order
from safestart.store.records import JobPage, JobStatus
from safestart_service.access.gate import caller, ended_key, require_own
from safestart_service.documents.jobs_view import job_detail, known_job, partial_document, status_infos
from safestart_service.documents.openapi import TAG, answer, json_body, refusals
from safestart_service.documents.schemas import JobDetail, JobLabels, JobList, Partial
from safestart_service.http.answers import Json, base_url, link, tagged, this_url
from safestart_service.http.body import parse_body, read_body
from safestart_service.http.intervals import interval, without_nul
from safestart_service.http.strict import StrictRoute
from safestart_service.state import services

router = APIRouter(tags=["jobs"], route_class=StrictRoute)
MAX_WAIT_S = 30.0
MAX_OFFSET = 10_000_000
SORTS = tuple(sign + by.value for by in Order for sign in ("", "-"))
JobId = Annotated[str, Path(description="Id of a job.")]


class JobQuery(BaseModel):
    """Filters and paging of the job list."""

    model_config = ConfigDict(extra="forbid", populate_by_name=True)

    status: list[JobStatus] = Field([], max_length=5, description="Only jobs of these statuses.")
    type: list[Literal["process"]] = Field([], max_length=5, description="All jobs are processes.")
    processID: list[str] = Field([], max_length=50, description="Only jobs of these processes.")
    submitter: str | None = Field(
        None, max_length=64, description="Only jobs submitted with the key of this id."
    )
    datetime: str | None = Field(
        None,
        max_length=100,
        description="Only jobs created at this time or in this interval (RFC 3339): FROM/TO, ../TO, FROM/..",
        examples=["2026-11-22T00:00:00Z/.."],
    )
    minDuration: int | None = Field(
        None, ge=0, le=10**9, description="Only jobs that ran at least this long, s."
    )
    maxDuration: int | None = Field(
        None, ge=0, le=10**9, description="Only jobs that ran at most this long, s."
    )
    search: str | None = Field(
        None,
        max_length=200,
        description="Only jobs with each of these words in their id, process, name or a tag.",
        examples=["envisat night"],
    )
    tag: list[str] = Field([], max_length=10, description="Only jobs with all of these tags.")
    verdict: list[str] = Field(
        [], max_length=10, description="Only jobs whose outcome is one of these words."
    )
    sort: Literal[SORTS] = Field(  # type: ignore[valid-type]
        "-created", description="What the list is sorted by; with `-` from the greatest to the least."
    )
    limit: int = Field(50, ge=1, le=200, description="Jobs per page.")
    offset: int = Field(
        0,
        ge=0,
        le=MAX_OFFSET,
        description="Jobs before this page; a cursor, in the usual order, never shifts.",
    )
    cursor: str | None = Field(
        None, max_length=200, description="Where to continue: taken from the link `next` or `prev`."
    )


@router.get(
    "/jobs",
    operation_id="getJobs",
    summary="List of jobs",
    responses={200: answer(JobList, "A page of jobs.", ETag=TAG), **refusals(304, 422, 503)},
)
def jobs(request: Request, query: Annotated[JobQuery, Query()]) -> Response:
    """Jobs, newest first unless sorted otherwise; the links `next` and `prev` lead to the pages beside this one."""
    for name in query.processID:
        if name not in PROCESS_IDS:
            raise invalid("processID", f"one of {', '.join(PROCESS_IDS)}", name)
    found, base = services(request), base_url(request)
    start, end = interval("datetime", query.datetime)
    wanted = JobFilter(
        statuses=query.status,
        process_ids=query.processID,
        submitter=None if query.submitter is None else without_nul(query.submitter),
        created_from=start,
        created_to=end,
        least_s=query.minDuration,
        most_s=query.maxDuration,
        words=without_nul(query.search or "").split(),
        tags=[without_nul(tag) for tag in query.tag],
        verdicts=[without_nul(word) for word in query.verdict],
    )
    page = found.jobs.list(
        wanted,
        limit=query.limit,
        cursor=query.cursor,
        offset=query.offset,
        by=Order(query.sort.removeprefix("-")),
        descending=query.sort.startswith("-"),
    )
    links = [link(this_url(request), "self", "this list")]
    for rel, title, place in _beside(query, page):
        again = query.model_dump(mode="json", exclude_defaults=True, exclude={"cursor", "offset"}) | place
        links.append(link(f"{base}/jobs?{urlencode(again, doseq=True)}", rel, title))
    return tagged(request, {"jobs": status_infos(found, page, base), "total": page.total, "links": links})


def _beside(query: JobQuery, page: JobPage) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """The pages beside this one: by cursor in the usual order, else by offset."""
    after = query.offset + query.limit
    if page.next_cursor is not None:
        yield "next", "next page", {"cursor": page.next_cursor}
    elif (query.offset or query.sort != "-created") and after < min(page.total, MAX_OFFSET):
        yield "next", "next page", {"offset": after}
    if page.prev_cursor is not None:
        yield "prev", "previous page", {"cursor": page.prev_cursor}
    elif query.offset:
        yield "prev", "previous page", {"offset": max(0, query.offset - query.limit)}


@router.get(
    "/jobs/{jobID}",
    operation_id="getStatus",
    summary="Status of a job",
    responses={200: answer(JobDetail, "statusInfo.", ETag=TAG), **refusals(304, 404, 422, 503)},
)
async def job(
    request: Request,
    jobID: JobId,
    wait: Annotated[
        float,
        Query(ge=0, le=MAX_WAIT_S, description="Answer when the job has ended, or after this many seconds."),
    ] = 0.0,
) -> Response:
    """Status with progress, place in the queue and why it waits, estimated time left.

    With ``wait`` the answer comes when the job has ended, with If-None-Match as soon as anything has changed, and after
    so many seconds at the latest.
    """
    found, base = services(request), base_url(request)
    until_change = "if-none-match" in request.headers
    deadline = monotonic() + wait

    def look() -> tuple[bool, Response]:
        now = known_job(found, jobID)
        seen = tagged(request, job_detail(found, now, base))
        return now.status.ended or (until_change and seen.status_code == 200), seen

    # Not in the threads for instant answers: a client that follows a job must not wait for those.
    final, seen = await run_in_threadpool(look)
    if final or wait <= 0:
        return seen
    with found.following.place(request):
        while not final and (left := deadline - monotonic()) > 0 and not await request.is_disconnected():
            if not await found.following.pause(request, left):
                raise ended_key()
            final, seen = await run_in_threadpool(look)
    return seen


@router.get(
    "/jobs/{jobID}/partial",
    operation_id="getPartialResult",
    summary="Partial result of a job",
    responses={200: answer(Partial, "Finished parts and their summary."), **refusals(404, 422, 503)},
)
def partial(request: Request, jobID: JobId) -> Response:
    """The result so far of a process that is cut into parts; once the job is successful, ask for its results."""
    found = services(request)
    return Json(partial_document(found, known_job(found, jobID), base_url(request)))


@router.patch(
    "/jobs/{jobID}",
    operation_id="label",
    summary="Name a job, tag it, write a note on it",
    openapi_extra=json_body(
        {"labels": JobLabels}, {"labels": {"name": "before the burn", "tags": ["envisat"]}}
    ),
    responses={
        200: answer(JobDetail, "statusInfo with the labels."),
        **refusals(404, 409, 413, 415, 422, 503),
    },
)
async def label(request: Request, jobID: JobId) -> Response:
    """Write the given ones of name, tags and note; they change nothing that is computed.

    With keys in use: on one's own jobs; with role admin, on any.
    """
    labels = parse_body(JobLabels, await read_body(request))
    found, by = services(request), caller(request)

    def write() -> Response:
        require_own(by, known_job(found, jobID).submitter)
        now = found.jobs.label(jobID, name=labels.name, tags=labels.tags, note=labels.note, by=by)
        return Json(job_detail(found, now, base_url(request)))

    return await run_in_threadpool(write)


@router.delete(
    "/jobs/{jobID}",
    operation_id="dismiss",
    summary="Dismiss a job",
    responses={200: answer(JobDetail, "statusInfo after the dismissal."), **refusals(404, 409, 422, 503)},
)
def dismiss(request: Request, jobID: JobId) -> Response:
    """Dismiss a waiting job at once; a running one is asked to stop, and stops soon.

    With keys in use: one's own jobs; with role admin, any.
    """
    found = services(request)
    by = caller(request)
    require_own(by, known_job(found, jobID).submitter)
    return Json(job_detail(found, found.jobs.dismiss(jobID, by), base_url(request)))
