"""Light answers in a few threads beside the event loop. A pool has so many threads and so many callers in line.

Work whose client has left is not begun, and what is under way is told to stop: a page asks again with every move of a
slider.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import TypeVar

from fastapi import Request
from starlette.requests import ClientDisconnect

from safestart.errors import Cancelled, SafestartError
from safestart.runtime.children.forks import Forkable
from safestart_service.access.callers import Callers
from safestart_service.computing.in_thread import begun

Answer = TypeVar("Answer")
Left = Callable[[], bool]
"""Whether the client has left."""


class Threads(Forkable):
    """``threads`` threads for one class of work, which is called ``what`` in refusals; ``most`` callers at once."""

    def __init__(self, what: str, threads: int, most: int) -> None:
        self.callers = Callers(what, most)
        self._threads, self._name = threads, what.split()[0]
        self.open()
        self.tell_of_forks()

    def open(self) -> None:
        """Begin, or begin again after :meth:`close`."""
        self._pool = ThreadPoolExecutor(self._threads, self._name)

    async def __call__(self, request: Request, work: Callable[[Left], Answer]) -> Answer:
        """Do the work in a thread.

        Raises ``RateLimited`` where too much is in line, ``ClientDisconnect`` when the client has left, and what
        :mod:`safestart_service.shortage` knows where there is no thread.
        """
        left = threading.Event()

        def wanted() -> Answer:
            if left.is_set():
                raise Cancelled("the caller left")
            return work(left.is_set)

        with self.callers.place(request):
            watch = asyncio.create_task(_watch(request, left))
            try:
                return await begun(self._pool, wanted)
            except Cancelled:
                raise ClientDisconnect from None
            finally:
                watch.cancel()

    def forked(self) -> None:
        """Have threads of this process."""
        self.open()

    def close(self) -> None:
        """Begin nothing more."""
        self._pool.shutdown(wait=False, cancel_futures=True)


async def _watch(request: Request, left: threading.Event) -> None:
    await leaves(request)
    left.set()


async def leaves(request: Request) -> None:
    """Return when the client has left. The body must have been read, or there is none."""
    with suppress(SafestartError):  # of a body that nobody asked for
        while (await request.receive())["type"] != "http.disconnect":
            pass
        return
    await asyncio.Event().wait()
