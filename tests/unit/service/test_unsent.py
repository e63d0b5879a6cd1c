"""Long answers that nobody reads share one budget of memory, of which one key has half."""

from __future__ import annotations

import asyncio
import json
from types import SimpleNamespace
from typing import Any

import pytest
from fastapi import FastAPI, Response

from safestart_service.computing.budget import Budget
from safestart_service.computing.unsent import PIECE
from safestart_service.http.answers import Shared
from safestart_service.http.limits import Limits

LONG, ALL = 3 * PIECE + 7, 7 * PIECE
BODY = bytes(range(256)) * (LONG // 256) + b"7" * (LONG % 256)


class Client:
    """A GET by a client that takes nothing after the first piece until ``reads`` is set."""

    def __init__(self, app: Limits, path: str, key: str | None = None, *, reads: bool = False) -> None:
        self.sent: list[dict[str, Any]] = []
        self.reads = asyncio.Event()
        if reads:
            self.reads.set()
        scope = {
            "type": "http",
            "method": "GET",
            "path": path,
            "root_path": "",
            "scheme": "http",
            "query_string": b"",
            "headers": [],
        }
        if key is not None:
            scope["safestart.key"] = SimpleNamespace(id=key)
        self.task = asyncio.ensure_future(app(scope, self._receive, self._send))

    async def _receive(self) -> dict[str, Any]:
        await asyncio.Event().wait()
        raise AssertionError

    async def _send(self, message: Any) -> None:
        if len(self.sent) > 1:
            await self.reads.wait()
        self.sent.append(message)

    async def began(self) -> None:
        while len(self.sent) < 2:
            await asyncio.sleep(0)

    async def answer(self) -> tuple[int, dict[bytes, bytes], bytes]:
        self.reads.set()
        await self.task
        start, *rest = self.sent
        assert [part.get("more_body", False) for part in rest] == [True] * (len(rest) - 1) + [False]
        assert max(len(part["body"]) for part in rest) <= PIECE
        return start["status"], dict(start["headers"]), b"".join(part["body"] for part in rest)


def limits(refused: list[int]) -> Limits:
    app = FastAPI()

    @app.get("/own")
    async def own() -> Response:
        return Response(BODY)

    @app.get("/shared")
    async def shared() -> Response:
        return Shared(BODY)

    return Limits(app, max_body_bytes=1000, answers=Budget(ALL), refused=refused.append)


def test_what_is_not_read_leaves_no_room_and_room_comes_back() -> None:
    async def scenario() -> None:
        refused: list[int] = []
        app = limits(refused)
        slow = [Client(app, "/own") for _ in range(2)]
        for one in slow:
            await one.began()
        assert app.answers is not None
        assert app.answers.taken == 2 * LONG
        status, headers, body = await Client(app, "/own", reads=True).answer()
        assert (status, refused) == (503, [503])
        assert int(headers[b"retry-after"]) > 0
        assert headers[b"x-content-type-options"] == b"nosniff"
        assert json.loads(body)["type"].endswith(":busy")
        shared = await Client(app, "/shared", reads=True).answer()
        assert (shared[0], shared[2]) == (200, BODY), "what is in memory once needs no room"
        status, headers, body = await slow[0].answer()
        assert (status, int(headers[b"content-length"]), body) == (200, LONG, BODY)
        assert (await Client(app, "/own", reads=True).answer())[0] == 200
        slow[1].task.cancel()
        await asyncio.gather(slow[1].task, return_exceptions=True)
        assert app.answers.taken == 0, "who has left holds nothing"

    asyncio.run(scenario())


def test_one_key_has_half() -> None:
    async def scenario() -> None:
        app = limits([])
        first = Client(app, "/own", "a")
        await first.began()
        assert (await Client(app, "/own", "a", reads=True).answer())[0] == 503
        assert (await Client(app, "/own", "b", reads=True).answer())[0] == 200
        assert (await first.answer())[0] == 200

    asyncio.run(scenario())


@pytest.mark.parametrize("name", [None, "a"])
def test_one_answer_alone_has_any_size(name: str | None) -> None:
    budget = Budget(10)
    assert budget.take(name, 50)
    assert not budget.take(name, 1)
    assert not budget.take("b", 1)
    budget.give_back(name, 50)
    assert budget.take("b", 1)
