"""CONNECT is refused like other methods; no bytes that offer to leave HTTP break a connection."""

from __future__ import annotations

import asyncio
import json
import random
from typing import Any

import pytest

from tests.contract.server.one_connection import House, answer, run
from tests.contract.server.raw_http import HOST, problem_in, said

TARGETS = [
    b"/",
    b"/healthz",
    b"example.org:443",
    b"[::1]:443",
    b"*",
    b"http://localhost",
    b"http://localhost/a?b",
]
GOOD = b"GET /healthz HTTP/1.1\r\n" + HOST + b"\r\n"
OFFER = b"Connection: upgrade\r\nUpgrade: h2c\r\n"


def connect(target: bytes, more: bytes = b"", version: bytes = b"1.1") -> bytes:
    return b"CONNECT " + target + b" HTTP/" + version + b"\r\n" + HOST + more + b"\r\n"


@pytest.mark.parametrize("piece", [1, 7, 100_000])
@pytest.mark.parametrize("target", TARGETS)
def test_it_is_answered_and_what_follows_is_no_request(address, target, piece):
    """Behind it come bytes for a tunnel: a request among them is not ours, though it looks like one."""
    asked = connect(target) + GOOD
    problem = problem_in(said(address, *(asked[k : k + piece] for k in range(0, len(asked), piece))), 405)
    assert "GET" in problem["required"]
    assert problem["received"] == "CONNECT"


@pytest.mark.parametrize("piece", [1, 100_000])
@pytest.mark.parametrize("target", TARGETS)
def test_requests_before_it_are_answered_first(address, target, piece):
    asked = GOOD * 2 + connect(target) + GOOD
    found = said(address, *(asked[k : k + piece] for k in range(0, len(asked), piece)))
    statuses = [part[:3] for part in found.split(b"HTTP/1.1 ")[1:]]
    assert statuses == [b"200", b"200", b"405"], found


@pytest.mark.parametrize(
    "more",
    [OFFER, b"Content-Length: 3\r\n", b"Transfer-Encoding: chunked\r\n", b"Expect: 100-continue\r\n"],
)
@pytest.mark.parametrize("version", [b"1.0", b"1.1"])
def test_with_fields_that_make_no_sense_beside_it(address, more, version):
    told = said(address, connect(b"example.org:443", more, version) + b"0\r\n\r\n" + GOOD)
    assert told.count(b"HTTP/1.1 ") == 1
    assert told[9:12] in (b"400", b"405"), told


def test_after_an_offer(address):
    offered = GOOD[:-2] + OFFER + b"\r\n"
    found = said(address, offered + connect(b"example.org:443", OFFER) + offered)
    assert [part[:3] for part in found.split(b"HTTP/1.1 ")[1:]] == [b"200", b"405"]


def broken_by(*streams: bytes) -> list[Any]:
    """What the event loop complains of, each stream on a connection of its own."""
    found: list[Any] = []

    async def app(scope: dict[str, Any], receive: Any, send: Any) -> None:
        await answer(send, json.dumps(scope["path"]).encode())

    async def visit() -> None:
        asyncio.get_running_loop().set_exception_handler(lambda _, context: found.append(context))
        for stream in streams:
            async with House(app).visited() as (_, peer):
                hearing = asyncio.create_task(peer.hear_all())
                for k in range(0, len(stream), 4096):
                    await peer.say(stream[k : k + 4096])
                peer.end()
                await hearing

    run(visit)
    return found


def test_thousands_of_offers_in_a_row():
    """Neither a stack that grows with them, nor a parser that forgets its place."""
    assert broken_by((GOOD[:-2] + OFFER + b"\r\n") * 5000) == []


def test_no_mixture_of_heads_breaks_a_connection():
    """Methods that httptools knows of other protocols, versions, offers, framings, targets and noise behind them."""
    chance = random.Random(8)
    methods = [
        b"CONNECT",
        b"GET",
        b"POST",
        b"PRI",
        b"SETUP",
        b"SOURCE",
        b"OPTIONS",
        b"M-SEARCH",
        b"FLUSH",
        b"QUERY",
    ]
    versions = [b"HTTP/1.1", b"HTTP/1.1", b"HTTP/1.0", b"HTTP/2.0", b"HTTP/0.9", b"RTSP/1.0", b"ICE/1.0"]
    fields = [
        OFFER,
        b"Upgrade: h2c\r\n",
        b"Connection: close, upgrade\r\nUpgrade: websocket\r\n",
        b"Content-Length: 3\r\n",
        b"Content-Length: 99999999999999999999\r\n",
        b"Transfer-Encoding: chunked\r\n",
        b"Transfer-Encoding: gzip\r\n",
        b"Transfer-Encoding: gzip, chunked\r\n",
        b"Proxy-Connection: upgrade\r\n",
        b"Expect: 100-continue\r\n",
    ]
    bodies = [
        b"",
        b"",
        b"abc",
        b"3\r\nabc\r\n0\r\n\r\n",
        b"0\r\nX: 1\r\n\r\n",
        b"\0\xff\r\n\r\n",
        b"PRI * HTTP/2.0\r\n\r\nSM",
    ]

    def head() -> bytes:
        line = b" ".join([chance.choice(methods), chance.choice(TARGETS), chance.choice(versions)]) + b"\r\n"
        some = chance.sample(fields, chance.randint(0, 3))
        return line + HOST + b"".join(some) + b"\r\n" + chance.choice(bodies)

    streams = [b"".join(head() for _ in range(chance.randint(1, 4))) for _ in range(3000)]
    assert broken_by(*streams) == []
