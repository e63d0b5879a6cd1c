"""Connections to the server's protocol, in this process: socket pairs with small buffers, and a simple application."""

from __future__ import annotations

import asyncio
import socket
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from functools import partial
from typing import Any

from uvicorn import Config
from uvicorn.server import ServerState

from safestart_service.http.places import Places
from safestart_service.http.wire import Protocol

App = Callable[[dict[str, Any], Any, Any], Awaitable[None]]
BUFFER = 8192


async def answer(send: Any, body: bytes = b"", status: int = 200) -> None:
    """Send a whole answer."""
    headers = [(b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})


class House:
    """A server without a listener: its connections are made by hand."""

    def __init__(self, app: App, places: int = 100, keep_alive: float = 5.0) -> None:
        self.state = ServerState()
        self.refused: list[int] = []
        self._config = Config(app, lifespan="off", ws="none", log_config=None, timeout_keep_alive=keep_alive)
        self._make = partial(Protocol, places=Places(places), refused=self.refused.append)

    @asynccontextmanager
    async def visited(self) -> AsyncIterator[tuple[Protocol, Peer]]:
        """The protocol of a new connection, and its peer."""
        loop = asyncio.get_running_loop()
        ours, theirs = socket.socketpair()
        for end in (ours, theirs):
            end.setblocking(False)
            for side in (socket.SO_SNDBUF, socket.SO_RCVBUF):
                end.setsockopt(socket.SOL_SOCKET, side, BUFFER)
        _, protocol = await loop.connect_accepted_socket(
            lambda: self._make(config=self._config, server_state=self.state, app_state={}), ours
        )
        with theirs:
            yield protocol, Peer(loop, theirs)


class Peer:
    """The other end."""

    def __init__(self, loop: asyncio.AbstractEventLoop, end: socket.socket) -> None:
        self._loop, self._end = loop, end

    async def say(self, data: bytes) -> None:
        """Send all of it, or as much as the other end takes before it closes."""
        with suppress(BrokenPipeError, ConnectionResetError):
            await self._loop.sock_sendall(self._end, data)

    def end(self) -> None:
        """Say no more: the other end closes when it has read everything."""
        with suppress(OSError):
            self._end.shutdown(socket.SHUT_WR)

    async def hear(self, most: int = 65536) -> bytes:
        """What is there, at most so many bytes; nothing when the other end has closed."""
        try:
            return await self._loop.sock_recv(self._end, most)
        except ConnectionResetError:
            return b""

    async def hear_all(self) -> bytes:
        """All until the other end closes."""
        found = b""
        while data := await self.hear():
            found += data
        return found


async def until(condition: Callable[[], Any]) -> None:
    """Wait until it holds; the test's own time limit ends a wait for ever."""
    while not condition():
        await asyncio.sleep(0.005)


def run(test: Callable[[], Awaitable[None]]) -> None:
    """Run a coroutine on the loop that the server uses."""
    factory = None
    if sys.platform != "win32":
        import uvloop

        factory = uvloop.new_event_loop
    with asyncio.Runner(loop_factory=factory) as runner:
        runner.run(asyncio.wait_for(test(), 60.0))
