"""What a worker that has just started still compiles, and which jobs need not wait for it.

A job starts when the kernels of its process are there. What the next job needs is compiled first, by as many task
processes as are free; the rest follows beside running jobs, and last the modules that no job has loaded yet.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Awaitable, Callable, Iterable

from distributed import KilledWorker
from distributed.client import FutureCancelledError

from safestart.errors import NotFound
from safestart.processes.registry import process
from safestart.runtime.kernels.warmup import PARTS
from safestart_worker.cluster.cluster import Cluster

log = logging.getLogger("safestart.worker")

# Longest time that jobs wait for kernels. On a shared cluster they may queue behind the jobs of others.
PATIENCE_S = 120.0
PATIENCE_SHARED_S = 10.0


class Kernels:
    """The parts of the warm-up: those that are left, those that are compiled now, those that are there."""

    def __init__(self, cluster: Cluster, parts: Iterable[str] = tuple(PARTS), *, ahead: bool = True) -> None:
        """``ahead``: compile what no waiting job needs, too, and load it in every process."""
        self._cluster = cluster
        self._ahead = ahead
        self._left = list(parts)
        self._running: dict[str, asyncio.Task[None]] = {}
        self._wanted: tuple[str, ...] = ()
        self._last: asyncio.Task[None] | None = None
        self._begun = time.monotonic()
        self._patience_s = PATIENCE_S if cluster.embedded else PATIENCE_SHARED_S
        self.failed = False
        """True when a part cannot be compiled: jobs would fail, too, and a new worker may do better."""
        self.on_change: Callable[[], None] = lambda: None
        """Called when a part is there, or has failed."""

    @property
    def over(self) -> bool:
        """True when no job waits for kernels any more."""
        return not (self._left or self._running) or time.monotonic() - self._begun > self._patience_s

    def there(self, process_id: str) -> bool:
        """Whether a job of this process finds its kernels compiled; if not, they come next."""
        if self.over:
            return True
        try:
            needed = process(process_id).kernels
        except NotFound:
            needed = ()  # its task says so
        self._wanted = tuple(part for part in needed if part in self._left or part in self._running)
        return not self._wanted

    def go_on(self, free: int) -> None:
        """Compile on, as far as ``free`` task processes allow; while a job waits, only what it needs."""
        first = [part for part in self._left if part in self._wanted]
        while len(self._running) < free and (first or (self._ahead and self._left and not self._wanted)):
            part = first.pop(0) if first else self._left[0]
            self._left.remove(part)
            self._running[part] = asyncio.ensure_future(self._one(part))

    def stop(self) -> None:
        """Wait for no part any more."""
        for task in (*self._running.values(), *([self._last] if self._last else [])):
            task.cancel()

    async def _one(self, part: str) -> None:
        begun = time.monotonic()
        done = await self._kept(part, self._cluster.compile(part))
        del self._running[part]
        self._wanted = tuple(one for one in self._wanted if one != part)
        if done:
            log.info("kernels of %s are there after %.1f s", part, time.monotonic() - begun)
        if not (self._left or self._running or self.failed):
            log.info("all kernels are there after %.1f s", time.monotonic() - self._begun)
            if self._ahead:
                self._last = asyncio.ensure_future(self._everywhere())
        self.on_change()

    async def _everywhere(self) -> None:
        """All modules and kernels in every process, so that no later job loads them."""
        if await self._kept("modules and kernels", self._cluster.warm_all()):
            log.info(
                "every process holds all modules and kernels after %.1f s", time.monotonic() - self._begun
            )

    async def _kept(self, what: str, work: Awaitable[None]) -> bool:
        """Whether ``work`` has ended well; an error of it ends the worker."""
        try:
            await work
        except (KilledWorker, FutureCancelledError):
            # The process was killed for a job that it ran beside: jobs compile what they miss.
            log.warning("%s: the task process that warmed up was ended", what)
            return False
        except Exception:
            self.failed = True
            log.exception("%s: warming up failed: this worker takes no jobs and ends", what)
            return False
        return True
