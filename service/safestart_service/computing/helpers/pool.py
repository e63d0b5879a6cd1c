"""At most so many calls at once in helper processes.

A call that is cancelled is told to stop. One that does not within :data:`GRACE_S` (a solver's call in C) is killed.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from typing import Any, TypeVar

from safestart_service.computing.helpers.process import Helper, HelperEnded, NotBegun
from safestart_service.computing.helpers.sources import FORKS, Forked, Source, Spawned
from safestart_service.computing.in_thread import begun

Answer = TypeVar("Answer")
GRACE_S = 0.5
TRIES = 3
"""A process that was killed a moment ago still takes a call, which then goes to another one."""


class Pool:
    """At most ``most`` calls at once; a helper is kept when its call is done."""

    def __init__(self, most: int, source: Source | None = None) -> None:
        self._source = source or (Forked() if FORKS else Spawned())
        self._most = most
        self._threads = ThreadPoolExecutor(most + 1, "helper")  # one more starts the first helper
        self._idle: list[Helper] = []
        self._busy: set[Helper] = set()

    async def start(self) -> None:
        """Have a helper that waits for a call; raises ``HelperEnded``."""
        self._idle.append(await self._helper())

    def ready(self) -> bool:
        """Whether a call would begin at once, or when another one ends."""
        there = not all(helper.ended() for helper in self._idle) or len(self._busy) >= self._most
        return there or self._source.ready()

    async def __call__(self, function: Callable[..., Answer], *arguments: Any) -> Answer:
        """``function(*arguments)`` in a helper; raises what it raises, and ``HelperEnded``."""
        for _ in range(TRIES - 1):
            with suppress(NotBegun):
                return await self._once(function, arguments)
        return await self._once(function, arguments)

    async def _once(self, function: Callable[..., Answer], arguments: tuple[Any, ...]) -> Answer:
        helper = await self._helper()
        self._busy.add(helper)
        try:
            call = self._in_thread(helper.ask, function, arguments)
            try:
                returned, answer = await asyncio.shield(call)
            except asyncio.CancelledError:
                await self._given_up(helper, call)
                raise
            self._keep(helper)
        finally:
            self._busy.discard(helper)
        if not returned:
            raise answer
        found: Answer = answer
        return found

    async def _given_up(self, helper: Helper, call: asyncio.Future[Any]) -> None:
        """Have the helper stop, or end it."""
        stopped = False
        try:
            helper.stop()
            await asyncio.wait({call}, timeout=GRACE_S)
            stopped = call.done() and not call.cancelled() and call.exception() is None
        finally:
            if stopped:
                self._keep(helper)
            else:
                helper.kill()

    def _keep(self, helper: Helper) -> None:
        if not helper.spent:
            self._idle.append(helper)

    async def _helper(self) -> Helper:
        while self._idle:
            helper = self._idle.pop()
            if not helper.ended():
                return helper
        return await asyncio.shield(self._in_thread(self._source.helper))

    def _in_thread(self, work: Callable[..., Answer], *arguments: Any) -> asyncio.Future[Answer]:
        try:
            future = begun(self._threads, partial(work, *arguments))
        except RuntimeError as error:  # the system gives us no thread, or this is closed
            raise HelperEnded from error
        # Cancelled, nobody waits for its end any more, and nobody needs to know how it ended.
        future.add_done_callback(lambda done: None if done.cancelled() else done.exception())
        return future

    def close(self) -> None:
        """End all processes, and with them the threads that wait for one."""
        self._source.close()
        for helper in (*self._idle, *self._busy):
            helper.kill()
        self._idle.clear()
        self._threads.shutdown(wait=False, cancel_futures=True)
