"""An HTTP load of keep-alive connections, in process: each sends its next request when it has its answer, or at a pace.

At a pace the time of an answer counts from when its request was due, also where the answer before it came later than
that: a slow server cannot hide behind clients that wait for it.
"""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Sequence
from itertools import cycle
from time import perf_counter
from typing import cast

PATIENCE_S = 300.0
"""Beyond the time of the load; under it the service starts more helper processes, a minute each on a busy machine."""
# Paced connections are made before the first of them has to ask.
CONNECTING_S = 1.0


class _Connection(asyncio.Protocol):
    """Counts complete answers by their Content-Length; anything but 200 is an error."""

    def __init__(self, requests: Iterator[bytes], due: float, stop_at: float, gap_s: float) -> None:
        self.requests = requests
        self.due = due
        self.stop_at = stop_at
        self.gap_s = gap_s
        self.times: list[float] = []
        self.error: Exception | None = None
        self.done: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._buffer = b""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast(asyncio.Transport, transport)  # uvloop's class does not derive from asyncio's
        self._ask_when_due()

    def _ask_when_due(self) -> None:
        wait = self.due - perf_counter()
        if wait > 0.0:
            asyncio.get_running_loop().call_later(wait, self._ask)
        else:
            self._ask()

    def _ask(self) -> None:
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
        self.times.append(now - self.due)
        self.due = self.due + self.gap_s if self.gap_s else now
        if self.due < self.stop_at:
            self._ask_when_due()
        else:
            self._transport.close()

    def connection_lost(self, exc: Exception | None) -> None:
        self.error = self.error or exc
        if not self.done.done():
            self.done.set_result(None)


async def _load(
    port: int, paths: Sequence[str], seconds: float, connections: int, more: str, per_s: float = 0.0
) -> tuple[list[float], float]:
    loop = asyncio.get_running_loop()
    lines = f" HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nAccept: application/json\r\n{more}\r\n"
    requests = cycle([f"GET {path}{lines}".encode() for path in paths])
    gap_s = connections / per_s if per_s else 0.0
    start = perf_counter() + (CONNECTING_S if per_s else 0.0)
    made = []
    for number in range(connections):
        due = start + gap_s * number / connections
        _, protocol = await loop.create_connection(
            lambda due=due: _Connection(requests, due if per_s else perf_counter(), start + seconds, gap_s),  # type: ignore[misc]
            "127.0.0.1",
            port,
        )
        made.append(protocol)
    limit_s = seconds + PATIENCE_S
    try:
        await asyncio.wait_for(asyncio.gather(*(connection.done for connection in made)), limit_s)
    except TimeoutError:
        raise TimeoutError(
            f"port {port}: required the last answer to a load of {seconds:g} s within {limit_s:g} s ({paths[0]})"
        ) from None
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


def latencies(
    port: int, paths: Sequence[str], seconds: float, connections: int, per_s: float = 0.0
) -> list[float]:
    """Seconds that each answer took; ``per_s`` requests in all per second, or (0) each as soon as its client can."""
    import uvloop

    return uvloop.run(_load(port, paths, seconds, connections, "", per_s))[0]
