"""Events of a job as a resumable stream of server-sent events."""

from __future__ import annotations

from collections.abc import AsyncIterator
from time import monotonic
from typing import Any

import orjson
from fastapi import Request
from starlette.concurrency import run_in_threadpool

from safestart.errors import invalid
from safestart.store.records import Event, JobStatus
from safestart_service.state import Services, services

KEEP_ALIVE_S = 15.0
PAGE = 500


def resume_point(header: str | None) -> int:
    """The event id in a ``Last-Event-ID`` header; 0 without one."""
    if header is None or header == "":
        return 0
    if not (header.isascii() and header.isdigit() and len(header) <= 18):
        raise invalid("Last-Event-ID", "the id of an event", header)
    return int(header)


def encode(event: Event) -> bytes:
    """One event in the format of the HTML standard; our JSON has no line breaks, so one data line is enough."""
    data: dict[str, Any] = {"at": event.at, **event.data}
    return b"id: %d\nevent: %s\ndata: %s\n\n" % (event.id, event.kind.encode(), orjson.dumps(data))


async def stream(request: Request, job_id: str, after: int) -> AsyncIterator[bytes]:
    """Events after ``after`` until the job has ended and all were sent; comments keep idle connections open.

    The stream ends earlier when the caller's key ends.

    The status is read before the events: once it is final, that read has all events.
    """
    found, spoke = services(request), monotonic()
    yield b"retry: 1000\n\n"
    while True:
        ended, events = await run_in_threadpool(_look, found, job_id, after)
        if not found.access.still_passes(request):
            return
        if events:
            after = events[-1].id
            spoke = monotonic()
            yield b"".join(encode(event) for event in events)
        if len(events) == PAGE:
            continue
        if ended:
            return
        if monotonic() - spoke > KEEP_ALIVE_S:
            spoke = monotonic()
            yield b": still here\n\n"
        if not await found.following.pause(request):
            return


def _look(found: Services, job_id: str, after: int) -> tuple[bool, tuple[Event, ...]]:
    status: JobStatus = found.jobs.get(job_id).status
    return status.ended, found.jobs.events(job_id, after, PAGE)
