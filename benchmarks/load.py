"""A closed-loop HTTP load of keep-alive connections, in process: each sends its next request when it has its answer."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Sequence
from itertools import cycle
from time import perf_counter
from typing import cast

PATIENCE_S = 20.0


class _Connection(asyncio.Protocol):
    """Counts complete answers by their Content-Length; anything but 200 is an error."""

    def __init__(self, requests: Iterator[bytes], stop_at: float) -> None:
        self.requests = requests
        self.stop_at = stop_at
        self.times: list[float] = []
        self.error: Exception | None = None
        self.done: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._buffer = b""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast(asyncio.Transport, transport)  # uvloop's is none of asyncio's classes
        self._ask()

    def _ask(self) -> None:
        self._asked = perf_counter()
        self._transport.write(next(self.requests))

    def data_received(self, data: bytes) -> None:
        self._buffer += data
        head, separator, body = self._buffer.partition(b"\r\n\r\n")
        if not separator:
            return
        if not head.startswith(b"HTTP/1.1 200"):
            self.error = RuntimeError(self._buffer[:400].decode("latin-1"))
            self._transport.close()
            return
        start = head.lower().index(b"content-length:") + 15
        length = int(head[start:].partition(b"\r\n")[0])
        if len(body) < length:
            return
        self._buffer = b""
        now = perf_counter()
        self.times.append(now - self._asked)
        if now < self.stop_at:
            self._ask()
        else:
            self._transport.close()

    def connection_lost(self, exc: Exception | None) -> None:
        self.error = self.error or exc
        if not self.done.done():
            self.done.set_result(None)


async def _load(
    port: int, paths: Sequence[str], seconds: float, connections: int, more: str
) -> tuple[list[float], float]:
    loop = asyncio.get_running_loop()
    lines = f" HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nAccept: application/json\r\n{more}\r\n"
    requests = cycle([f"GET {path}{lines}".encode() for path in paths])
    start = perf_counter()
    made = []
    for _ in range(connections):
        _, protocol = await loop.create_connection(
            lambda: _Connection(requests, start + seconds), "127.0.0.1", port
        )
        made.append(protocol)
    await asyncio.wait_for(asyncio.gather(*(connection.done for connection in made)), seconds + PATIENCE_S)
    for connection in made:
        if connection.error is not None:
            raise connection.error
    return [taken for connection in made for taken in connection.times], perf_counter() - start


def requests_per_second(
    port: int, paths: Sequence[str], seconds: float, connections: int = 16, more: str = ""
) -> float:
    """Answers per second on the loopback port; the paths are asked for in turn, with ``more`` header lines."""
    import uvloop

    times, took = uvloop.run(_load(port, paths, seconds, connections, more))
    return len(times) / took


def latencies(port: int, paths: Sequence[str], seconds: float, connections: int) -> list[float]:
    """Seconds that each answer took."""
    import uvloop

    return uvloop.run(_load(port, paths, seconds, connections, ""))[0]
