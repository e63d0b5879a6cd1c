"""What one connection may hold, and for how long, whatever its peer does."""

from __future__ import annotations

import asyncio
import gc
import weakref
from contextlib import AsyncExitStack
from functools import wraps
from typing import Any

import pytest

from safestart_service.http import unread, wire
from safestart_service.http.wire import MAX_HEAD_BYTES, MOST_AHEAD, MOST_TURNED_AWAY
from tests.contract.server.one_connection import House, answer, run, until
from tests.contract.server.raw_http import HOST, problem_in

ASKED = b"GET / HTTP/1.1\r\n" + HOST + b"\r\n"
POST = b"POST / HTTP/1.1\r\n" + HOST
CHUNKED = POST + b"Transfer-Encoding: chunked\r\n\r\n"
LONG = b"x" * 60_000
"""Longer than all buffers of a socket, shorter than what asyncio holds before it reports."""
NEVER = 1e6


def on_the_loop(test: Any) -> Any:
    @wraps(test)
    def in_a_loop(*args: Any, **kwargs: Any) -> None:
        run(lambda: test(*args, **kwargs))

    return in_a_loop


@pytest.fixture
def patience(monkeypatch):
    """Sets the deadlines; without a value none ends."""

    def chosen(head: float = NEVER, reader: float = NEVER, turned_away: float = NEVER) -> None:
        monkeypatch.setattr(wire, "HEAD_S", head)
        monkeypatch.setattr(wire, "TURNED_AWAY_S", turned_away)
        monkeypatch.setattr(unread, "UNREAD_S", reader)

    chosen()
    return chosen


async def long_answers(scope, receive, send):
    await answer(send, LONG)


class Waiting:
    """Answers each request when it is told to, and knows what it was asked and who left."""

    def __init__(self) -> None:
        self.may, self.asked, self.left, self.size = asyncio.Semaphore(0), 0, 0, 0

    async def __call__(self, scope, receive, send):
        self.asked += 1
        while (message := await receive())["type"] == "http.request":
            self.size += len(message["body"])
            if not message["more_body"]:
                break
        told = asyncio.ensure_future(self.may.acquire())
        gone = asyncio.ensure_future(receive())
        done, others = await asyncio.wait({told, gone}, return_when=asyncio.FIRST_COMPLETED)
        for other in others:
            other.cancel()
        if gone in done:
            self.left += 1
        else:
            await answer(send)


@on_the_loop
async def test_a_short_answer_that_nobody_reads(patience):
    """Closing waits for ever until all is sent, so even little unread data must be noticed."""
    patience(head=0.05, reader=0.1)
    house = House(long_answers)
    async with house.visited() as (protocol, peer):
        await peer.say(ASKED)
        await until(lambda: protocol.transport.get_write_buffer_size())
        await until(lambda: not house.state.connections)


@on_the_loop
async def test_who_reads_slowly_is_waited_for(patience):
    house = House(long_answers)
    async with house.visited() as (protocol, peer):
        await peer.say(ASKED)
        await until(lambda: protocol.transport.get_write_buffer_size())
        before = protocol.transport.get_write_buffer_size()
        while protocol.transport.get_write_buffer_size() == before:
            await peer.hear(4096)
            await asyncio.sleep(0)
        protocol._look()
        assert not protocol.transport.is_closing(), "something was taken: look again"
        protocol._look()
        await until(lambda: not house.state.connections)


@on_the_loop
async def test_who_has_read_everything_is_not_cut(patience):
    async with House(long_answers).visited() as (protocol, peer):
        await peer.say(ASKED)
        await until(lambda: protocol.transport.get_write_buffer_size())
        found = b""
        while not found.endswith(LONG):
            found += await peer.hear()
        await until(lambda: not protocol.flow.write_paused)
        assert protocol._unread is None, "else it would be cut later, with nothing left to read"


@on_the_loop
async def test_nobody_makes_us_read_ahead_without_end(patience):
    """Behind a slow request unread data waits in its sender's memory; later each answer makes room for few."""
    app = Waiting()
    async with House(app).visited() as (protocol, peer):
        sent = asyncio.ensure_future(peer.say(ASKED * 60_000))
        await until(lambda: protocol._held)
        for _ in range(60_000):
            app.may.release()
        heard, most, held = 0, 0, 0
        while heard < 600:
            heard += (await peer.hear(4096)).count(b"HTTP/1.1 200")
            most, held = max(most, len(protocol.pipeline)), max(held, len(protocol._held))
        assert most < MOST_AHEAD + wire._PIECE // len(ASKED) + 1
        assert held <= 2**18, "what one read of the event loop brings"
        sent.cancel()


@on_the_loop
async def test_slow_answers_are_waited_for(patience):
    """The deadline is that of heads: it ends with the head, and begins when no request is left to answer."""
    app = Waiting()
    async with House(app).visited() as (protocol, peer):
        assert protocol._deadline is not None
        await peer.say(ASKED * 3)
        for number in range(1, 4):
            await until(lambda: app.asked == number)  # noqa: B023
            assert protocol._deadline is None
            app.may.release()
            assert (await peer.hear()).startswith(b"HTTP/1.1 200")
        await until(lambda: protocol._deadline)
        protocol._too_slow()
        assert await peer.hear_all() == b"", "nothing was asked, so nothing is answered"


@on_the_loop
async def test_a_long_body_is_no_head(patience):
    app = Waiting()
    app.may.release()
    async with House(app).visited() as (_, peer):
        size = 3 * MAX_HEAD_BYTES
        await peer.say(POST + b"Content-Length: %d\r\n\r\n" % size + b"x" * size)
        assert (await peer.hear()).startswith(b"HTTP/1.1 200")
        assert app.size == size


@pytest.mark.parametrize("endless", [ASKED[:-2] + b"X-A: ", CHUNKED + b"2;", CHUNKED + b"0\r\nX-A: "])
@on_the_loop
async def test_what_is_neither_head_nor_body_ends(patience, endless):
    """Headers, chunk extensions and trailers without end, on one connection with a request before."""
    app, house = Waiting(), None
    app.may.release()
    house = House(app)
    async with house.visited() as (_, peer):
        await peer.say(ASKED)
        assert (await peer.hear()).startswith(b"HTTP/1.1 200")
        sent = asyncio.ensure_future(peer.say(endless + b"a" * 2 * MAX_HEAD_BYTES))
        problem_in(await peer.hear_all(), 431)
        assert house.refused == [431]
        await until(lambda: app.left == app.asked - 1)  # the handler that waits for a body hears of it
        sent.cancel()


@on_the_loop
async def test_a_refused_request_is_not_served(patience):
    """Also when the rest of it came with the bytes that are too many."""
    app = Waiting()
    house = House(app)
    async with house.visited() as (protocol, peer):
        protocol.data_received(ASKED[:-2] + b"X-A: " + b"a" * 2 * MAX_HEAD_BYTES + b"\r\n\r\n" + ASKED)
        problem_in(await peer.hear_all(), 431)
        assert (app.asked, house.refused) == (0, [431])


@on_the_loop
async def test_one_refusal_however_long_it_stays_unread(patience):
    """A head that broke off behind an unread answer is refused once, not again when its time is over."""
    house = House(long_answers)
    async with house.visited() as (protocol, peer):
        await peer.say(ASKED)
        await until(lambda: protocol.transport.get_write_buffer_size())
        await until(lambda: protocol.cycle.response_complete)
        await peer.say(b"GET / HTTP/1.1\r\nX-A: \x00")
        await until(lambda: house.refused)
        protocol._too_slow()
        assert house.refused == [400]
        assert (await peer.hear_all()).count(b"HTTP/1.1 400") == 1


@pytest.mark.parametrize("answered", [0, 1])
@on_the_loop
async def test_who_leaves_is_not_worked_for(patience, answered):
    """Also with a request still in the queue: uvicorn tells only the handler of the latest."""
    app = Waiting()
    async with House(app).visited() as (protocol, peer):
        await peer.say(ASKED * 3)
        await until(lambda: app.asked and len(protocol.pipeline) == 2)
        for number in range(answered):
            app.may.release()
            await until(lambda: app.asked == number + 2)  # noqa: B023
    await until(lambda: app.left)
    assert app.asked == answered + 1


@on_the_loop
async def test_so_many_are_turned_away_at_a_time(patience):
    """They are heard out for a moment, so that they get the answer; but a flood of them is answered at once."""
    house = House(long_answers, places=1)
    async with AsyncExitStack() as held:
        peers = [(await held.enter_async_context(house.visited()))[1] for _ in range(1 + MOST_TURNED_AWAY)]
        _, last = await held.enter_async_context(house.visited())
        problem_in(await last.hear_all(), 503)
        assert len(house.state.connections) == 1 + MOST_TURNED_AWAY
        await peers[-1].say(ASKED)
        problem_in(await peers[-1].hear_all(), 503)
    assert house.refused == [503, 503]


@pytest.mark.parametrize("said", [b"", ASKED])
@on_the_loop
async def test_a_lost_connection_is_forgotten(patience, said):
    """No timer keeps it in memory: who connects and leaves again and again would fill it."""
    house = House(long_answers, keep_alive=0.01)
    async with house.visited() as (protocol, peer):
        transport, gone = protocol.transport, weakref.ref(protocol)
        del protocol
        await peer.say(said)
        if said:
            await until(transport.get_write_buffer_size)
    await until(lambda: not house.state.connections)
    await asyncio.sleep(0.05)
    gc.collect()
    assert gone() is None
