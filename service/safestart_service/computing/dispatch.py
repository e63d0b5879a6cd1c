"""Where an answer is computed: a light one in a thread, a heavy one in a helper process, a submission beside both."""

from __future__ import annotations

import asyncio
import os
from collections.abc import AsyncIterator
from io import BufferedReader, FileIO
from typing import Any

from fastapi import Request
from fastapi.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from safestart.processes.door import OneStart
from safestart.runtime.progress import Context
from safestart_service.access.gate import caller
from safestart_service.computing.budget import Share
from safestart_service.computing.light import Left
from safestart_service.computing.limits import LARGE_S, SMALL_BYTES
from safestart_service.computing.long_answers import place
from safestart_service.computing.unsent import PIECE, full
from safestart_service.computing.work import Asked, Made, at_once, in_full, one_start
from safestart_service.http.answers import base_url
from safestart_service.http.body import read_body
from safestart_service.state import services


async def posted(request: Request, process_id: str, **how: Any) -> Response:
    """Answer a POST; ``how`` are further fields of :class:`Asked`."""
    body = await read_body(request)
    asked = Asked(process_id, body, base_url(request), caller(request), **how)
    found = services(request)
    if asked.queued:
        found.access.require_submit(request)
    if len(body) > SMALL_BYTES:
        return await _heavy(request, LARGE_S, asked)

    def work(left: Left) -> Made | float:
        return at_once(found.store, Context(cancelled=left, shelf=found.store.shelf), asked)

    made = await (found.submitting if asked.queued else found.light)(request, work)
    if isinstance(made, float):
        return await _heavy(request, made, asked)
    return _response(made)


async def _heavy(request: Request, cost_s: float, asked: Asked) -> Response:
    helpers = services(request).helpers
    found = place()
    try:
        made: Made = await helpers(request, cost_s, in_full, asked, found and found.where)
        if found is None or not made.in_file:
            return _response(made)
        # Open, it outlives its name: it is gone when it has been sent, or when nobody wants it any more.
        file = found.taken()
        return _Sent(request, file, made)
    finally:
        if found is not None:
            found.close()


class _Sent(StreamingResponse):
    """A JSON document from an open file, which is closed at its end; raises ``Busy`` where it has no room.

    Its folder may be in memory, and is not without end elsewhere.
    """

    def __init__(self, request: Request, file: FileIO, made: Made) -> None:
        size, budget = os.fstat(file.fileno()).st_size, services(request).answers
        # Closing it waits for a thread that still reads: its number may be that of another answer a moment later.
        self._file = BufferedReader(file, PIECE)
        headers = made.headers | {"Content-Length": str(size)}
        super().__init__(_pieces(self._file), made.status, headers, media_type="application/json")
        self._share = Share(budget, caller(request).key_id)
        if not self._share.grow(size):
            self._file.close()
            raise full(budget)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send it."""
        try:
            with self._file:
                await super().__call__(scope, receive, send)
        finally:
            self._share.end()


async def _pieces(file: BufferedReader[FileIO]) -> AsyncIterator[bytes]:
    while piece := await asyncio.to_thread(file.read, PIECE):
        yield piece


async def one_document(request: Request, asked: OneStart) -> dict[str, Any]:
    """The document of one start whose method takes its time."""
    return await services(request).helpers(request, asked.cost(), one_start, asked)


def _response(made: Made) -> Response:
    return Response(made.body, made.status, made.headers, media_type="application/json")
