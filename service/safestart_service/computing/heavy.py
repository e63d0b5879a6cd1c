"""Heavy answers in helper processes: a deadline for each, and an end to what nobody waits for.

A helper is told to stop through a flag file, which its context reads. One that does not stop within :data:`GRACE_S`
(a solver's call in C) is killed and replaced.
"""

from __future__ import annotations

import asyncio
import logging
import shutil
import tempfile
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any, TypeVar

from fastapi import Request
from starlette.requests import ClientDisconnect

from safestart.errors import Cancelled, Unavailable
from safestart.runtime.settings import Settings
from safestart_service.access.callers import Callers
from safestart_service.access.gate import caller
from safestart_service.computing import inside
from safestart_service.computing.light import leaves
from safestart_service.computing.limits import too_long
from safestart_service.computing.line import Line
from safestart_service.computing.pool import HelperEnded, Pool

Answer = TypeVar("Answer")

MOST_HEAVY = 100
"""Heavy answers that are computed or wait for it."""
GRACE_S = 0.5
START_S = 60.0
"""An answer waits so long for a helper process that starts, beside its own time."""

log = logging.getLogger("safestart.service")


class Helpers:
    """The helper processes of one application."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self.callers = Callers("heavy answers are asked for", MOST_HEAVY)
        self.line = Line(settings.answer_processes)
        self._pool = Pool(settings.answer_processes)
        self._folder = _folder()
        self._numbers = count()
        self._warming: asyncio.Task[None] | None = None

    async def __call__(
        self, request: Request, cost_s: float, function: Callable[..., Answer], *arguments: Any
    ) -> Answer:
        """``function(store, context, *arguments)`` in a helper process.

        Raises ``RateLimited`` where too much is in line, ``AnswerTimeout`` for an answer that takes too long or would,
        ``Unavailable`` when no process is ready after a minute, ``ClientDisconnect`` when the client has left, and what
        the function raises.
        """
        limit_s = self._settings.answer_timeout_s
        if cost_s > limit_s:
            raise too_long(limit_s, cost_s)
        with self.callers.place(request):
            left = asyncio.ensure_future(leaves(request))
            try:
                # A process starts for seconds, and for minutes where no kernels are kept. An answer that paid for that
                # with its own time would be ended with its process, and the next one would begin anew.
                warm = self.warm()
                await asyncio.wait({warm, left}, timeout=START_S, return_when=asyncio.FIRST_COMPLETED)
                if left.done():
                    raise ClientDisconnect
                if not warm.done():
                    raise Unavailable(
                        "the process that computes such answers still starts: it loads and compiles its kernels; "
                        "required patience, or a job",
                        required="the same request later, or a job",
                    )
                return await self._in_time(request, left, cost_s, function, arguments)
            finally:
                left.cancel()

    async def _in_time(
        self,
        request: Request,
        left: asyncio.Future[Any],
        cost_s: float,
        function: Callable[..., Answer],
        arguments: tuple[Any, ...],
    ) -> Answer:
        limit_s = self._settings.answer_timeout_s
        stop = self.place()
        work = asyncio.ensure_future(self._work(caller(request).key_id, cost_s, function, stop, arguments))
        try:
            await asyncio.wait({work, left}, timeout=limit_s, return_when=asyncio.FIRST_COMPLETED)
            if not work.done():
                if stop is not None:
                    stop.touch()
                    await asyncio.wait({work}, timeout=GRACE_S)
                raise ClientDisconnect if left.done() else too_long(limit_s)
            return work.result()
        except Cancelled:
            raise ClientDisconnect from None
        finally:
            work.cancel()
            with suppress(BaseException):  # its end, not its answer, is waited for
                await work
            if stop is not None:
                stop.unlink(missing_ok=True)

    async def _work(
        self,
        name: str | None,
        cost_s: float,
        function: Callable[..., Answer],
        stop: Path | None,
        arguments: tuple[Any, ...],
    ) -> Answer:
        async with self.line.slot(name, cost_s):
            await asyncio.shield(self.warm())
            try:
                return await self._pool(inside.call, function, self._settings, stop, *arguments)
            except asyncio.CancelledError:
                # The process is killed. Where none can be forked the next one loads, in nobody's time for an answer.
                self._warming = None
                raise
            except HelperEnded:
                self._warming = None  # it may have taken the one that forks them along
                log.exception("a helper process ended while it computed an answer")
                raise Unavailable(
                    "the process that computed the answer ended; required a smaller question, or a job",
                    required="a smaller question, or a job",
                ) from None

    def place(self) -> Path | None:
        """A name for a file of this request's; None where nothing can be written."""
        return None if self._folder is None else self._folder / str(next(self._numbers))

    def warm(self) -> asyncio.Task[None]:
        """Start a helper process, unless one was started and has not ended; heavy answers wait for it."""
        if self._warming is None:
            self._warming = asyncio.ensure_future(self._start())
        return self._warming

    async def _start(self) -> None:
        with suppress(HelperEnded):
            await self._pool.start()

    def close(self) -> None:
        """End the processes and remove the flag files."""
        self._pool.close()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)


def _folder() -> Path | None:
    """Where flag files are; None where nothing can be written: then helpers are killed at once."""
    try:
        return Path(tempfile.mkdtemp(prefix="safestart-"))
    except OSError as error:
        log.warning("no place for temporary files (%s): abandoned answers end their process", error)
        return None
