"""Bodies in flight share one budget of memory: what does not fit is told to come back, and ended requests give back."""

from __future__ import annotations

import asyncio
import json
from typing import Any

import pytest
from fastapi import FastAPI, Request, Response

from safestart_service.documents import problems
from safestart_service.http.limits import Limits

BODY, ALL = 60, 100


class Asked:
    """A POST whose body comes in these pieces, as an ASGI server would pass it on."""

    def __init__(self, app: Limits, *pieces: bytes) -> None:
        self.sent: list[dict[str, Any]] = []
        self._pieces = list(pieces)
        scope = {
            "type": "http",
            "method": "POST",
            "path": "/",
            "root_path": "",
            "scheme": "http",
            "query_string": b"",
            "headers": [(b"transfer-encoding", b"chunked")],
        }
        self.task = asyncio.ensure_future(app(scope, self._receive, self._send))

    async def _receive(self) -> dict[str, Any]:
        piece = self._pieces.pop(0)
        return {"type": "http.request", "body": piece, "more_body": bool(self._pieces)}

    async def _send(self, message: Any) -> None:
        self.sent.append(message)

    async def answer(self) -> tuple[int, dict[bytes, bytes], bytes]:
        await self.task
        start, *rest = self.sent
        return start["status"], dict(start["headers"]), b"".join(part["body"] for part in rest)


def limits(held: asyncio.Event) -> Limits:
    """An application that reads the body and answers when told to."""
    app = FastAPI()
    problems.install(app)

    @app.post("/")
    async def take(request: Request) -> Response:
        await request.body()
        await held.wait()
        return Response()

    return Limits(app, max_body_bytes=BODY, max_bodies_bytes=ALL)


def test_what_does_not_fit_is_told_and_the_end_of_another_makes_room() -> None:
    async def scenario() -> None:
        held = asyncio.Event()
        app = limits(held)
        first = Asked(app, b"x" * 30, b"x" * 30)
        while app.bodies.taken < BODY:
            await asyncio.sleep(0)
        status, headers, body = await Asked(app, b"x" * 30, b"x" * 30).answer()
        assert status == 503
        assert int(headers[b"retry-after"]) > 0
        problem = json.loads(body)
        assert problem["type"].endswith(":busy")
        assert str(ALL) in problem["detail"]
        assert app.bodies.taken == BODY, "the refused request holds nothing"
        small = Asked(app, b"x" * 40)
        held.set()
        assert [(await one.answer())[0] for one in (first, small)] == [200, 200]
        assert app.bodies.taken == 0
        assert (await Asked(app, b"x" * BODY).answer())[0] == 200

    asyncio.run(scenario())


@pytest.mark.parametrize("pieces", [(b"x" * 61,), (b"x" * 40, b"x" * 21)])
def test_a_body_beyond_its_own_limit_is_another_refusal(pieces: tuple[bytes, ...]) -> None:
    async def scenario() -> tuple[int, int]:
        app = limits(asyncio.Event())
        status, _, _ = await Asked(app, *pieces).answer()
        return status, app.bodies.taken

    assert asyncio.run(scenario()) == (413, 0)
