"""Heavy answers in helper processes: a deadline for each, and an end to what nobody waits for."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

from fastapi import Request
from starlette.requests import ClientDisconnect

from safestart.errors import Unavailable
from safestart.runtime.settings import Settings
from safestart_service.access.callers import Callers
from safestart_service.access.gate import caller
from safestart_service.computing import inside
from safestart_service.computing.helpers.pool import Pool
from safestart_service.computing.helpers.process import HelperEnded
from safestart_service.computing.helpers.sources import Source
from safestart_service.computing.light import leaves
from safestart_service.computing.limits import too_long
from safestart_service.computing.line import Line

Answer = TypeVar("Answer")

MOST_HEAVY = 100
"""Heavy answers that are computed or wait for it."""
START_S = 60.0
"""An answer waits so long for a helper process that starts, beside its own time."""

STARTS = 3
"""A process that was killed while it loaded is started again."""

log = logging.getLogger("safestart.service")


class Helpers:
    """The helper processes of one application; ``source``: where those of its first life come from."""

    def __init__(self, settings: Settings, source: Source | None = None) -> None:
        self._settings = settings
        self._source = source
        self.callers = Callers("heavy answers are asked for", MOST_HEAVY)
        self.line = Line(settings.answer_processes)
        self.open()

    def open(self) -> None:
        """Begin, or begin again after :meth:`close`."""
        self._pool = Pool(self._settings.answer_processes, self._source)
        self._source = None  # closed with the pool
        self._loop: asyncio.AbstractEventLoop | None = None
        self._warming: asyncio.Task[None] | None = None
        self._leaving = asyncio.Event()

    async def __call__(
        self, request: Request, cost_s: float, function: Callable[..., Answer], *arguments: Any
    ) -> Answer:
        """``function(store, context, *arguments)`` in a helper process.

        Raises ``RateLimited`` where too much is in line, ``AnswerTimeout`` for an answer that takes too long or would,
        ``Unavailable`` when no process is ready after a minute or the service stops, ``ClientDisconnect`` when the
        client has left, and what the function raises.
        """
        limit_s = self._settings.answer_timeout_s
        if cost_s > limit_s:
            raise too_long(limit_s, cost_s)
        self._move_here()
        with self.callers.place(request):
            # Either ends the wait for an answer.
            left = asyncio.ensure_future(leaves(request))
            leaving = asyncio.ensure_future(self._leaving.wait())
            try:
                # A process starts for seconds, and for minutes where no kernels are kept. An answer that paid for that
                # with its own time would be ended with its process, and the next one would begin anew.
                if not await self._warm(left, leaving):
                    raise Unavailable(
                        "the process that computes such answers still starts: it loads and compiles its kernels; "
                        "required patience, or a job",
                        required="the same request later, or a job",
                    )
                work = asyncio.ensure_future(self._work(caller(request).key_id, cost_s, function, arguments))
                try:
                    await asyncio.wait(
                        {work, left, leaving}, timeout=limit_s, return_when=asyncio.FIRST_COMPLETED
                    )
                    if not work.done():
                        _require_there(left, leaving)
                        raise too_long(limit_s)
                    return work.result()
                finally:
                    work.cancel()
                    with suppress(BaseException):  # its end, not its answer, is waited for
                        await work
            finally:
                left.cancel()
                leaving.cancel()

    async def _work(
        self, name: str | None, cost_s: float, function: Callable[..., Answer], arguments: tuple[Any, ...]
    ) -> Answer:
        async with self.line.slot(name, cost_s):
            await asyncio.shield(self.warm())
            try:
                return await self._pool(inside.call, function, self._settings, *arguments)
            except HelperEnded:
                log.error("a helper process ended while it computed an answer")
                raise Unavailable(
                    "the process that computes the answer ended: it was killed, or this machine has no room for it; "
                    "required the same request later; a smaller question or a job, where that ends it again",
                    required="the same request later, a smaller question, or a job",
                ) from None

    async def _warm(self, *ends: asyncio.Future[Any]) -> bool:
        """Whether a process is there, or none can start, within the time for that; until then any end is one."""
        clock = asyncio.get_running_loop().time
        until = clock() + START_S
        for _ in range(STARTS):
            warm = self.warm()
            await asyncio.wait({warm, *ends}, timeout=until - clock(), return_when=asyncio.FIRST_COMPLETED)
            _require_there(*ends)
            if not warm.done():
                return False
            if self._pool.ready():
                break
        return True

    def warm(self) -> asyncio.Task[None]:
        """Start a helper process, unless one is there or starts; heavy answers wait for it.

        Where the process that forks them has ended too, the next one loads, in nobody's time for an answer.
        """
        self._move_here()
        if self._warming is None or (self._warming.done() and not self._pool.ready()):
            self._warming = asyncio.ensure_future(self._start())
        return self._warming

    def _move_here(self) -> None:
        """Leave the tasks of another event loop alone: a test client without a lifespan has one for each request."""
        loop = asyncio.get_running_loop()
        if self._loop is not loop:
            self._loop, self._warming, self._leaving = loop, None, asyncio.Event()

    def leave(self) -> None:
        """The service stops: answers that are not there yet are refused."""
        self._leaving.set()

    async def _start(self) -> None:
        with suppress(HelperEnded):
            await self._pool.start()

    def close(self) -> None:
        """End the processes."""
        self._pool.close()


def _require_there(left: asyncio.Future[Any], leaving: asyncio.Future[Any]) -> None:
    """The client and the service are still there."""
    if left.done():
        raise ClientDisconnect
    if leaving.done():
        raise Unavailable(
            "the service stops; required the same request later", required="the same request later"
        )
