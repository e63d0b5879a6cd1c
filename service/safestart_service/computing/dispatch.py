"""Where an answer is computed: a light one in a thread, a heavy one in a helper process, a submission beside both."""

from __future__ import annotations

from typing import Any

from fastapi import Request
from fastapi.responses import Response

from safestart.processes.go_no_go.spec import SPEC, GoNoGoInputs
from safestart.runtime.progress import Context
from safestart_service.access.gate import caller
from safestart_service.computing.light import Left
from safestart_service.computing.limits import LARGE_S, SMALL_BYTES
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
        return _response(await found.helpers(request, LARGE_S, in_full, asked))

    def work(left: Left) -> Made | float:
        return at_once(found.store, Context(cancelled=left, shelf=found.store.shelf), asked)

    made = await (found.submitting if asked.queued else found.light)(request, work)
    if isinstance(made, float):
        made = await found.helpers(request, made, in_full, asked)
    return _response(made)


async def one_document(request: Request, inputs: GoNoGoInputs) -> dict[str, Any]:
    """The document of one start whose method takes its time."""
    return await services(request).helpers(request, SPEC.cost(inputs), one_start, inputs)


def _response(made: Made) -> Response:
    return Response(made.body, made.status, made.headers, media_type="application/json")
