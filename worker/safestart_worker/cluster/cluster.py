"""A worker's operations on its Dask cluster; ``opening`` starts or finds a cluster."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar, cast

import psutil
from distributed import Client, Future, LocalCluster, Nanny

from safestart.runtime.kernels.warmup import warm
from safestart_worker.cluster.task import load, request_stop

Answer = TypeVar("Answer")

# Time for a polling task to stop by itself, and time for a replaced process to come back.
STOP_GRACE_S = 2.0
RESTART_TIMEOUT_S = 30.0
# Longest time that a stopping worker spends on its tasks on a cluster that stays.
LEAVE_TIMEOUT_S = 4.0
# Grace time before a local process is killed.
KILL_TIMEOUT_S = 0.5
# Dask's priority of the warm-up; jobs have 0, shards -1.
_LAST = -10
# States of a task that still has to run; in every other state the scheduler is done with it.
_TO_RUN = frozenset({"waiting", "no-worker", "queued", "processing"})


@dataclass(frozen=True, slots=True)
class Where:
    """Addresses of the processes that run some tasks now; ``over``: the scheduler has none of these tasks left."""

    processes: frozenset[str]
    over: bool


class Cluster:
    """A Dask client and this worker's operations on it."""

    def __init__(self, client: Client, owner: str, local: LocalCluster | None) -> None:
        self._client = client
        self._topic = f"safestart-{owner}"
        self._local = local
        self._size = 0 if local is None else len(local.workers)
        self._given_up = False

    @property
    def embedded(self) -> bool:
        """True when this worker owns the task processes."""
        return self._local is not None

    def listen(self, handler: Callable[[dict[str, Any]], None]) -> None:
        """Pass every report of our tasks to ``handler``."""
        self._client.subscribe_topic(self._topic, lambda event: handler(event[1]))

    @property
    def lost(self) -> str:
        """Why this cluster is unusable; empty while it is usable."""
        if self._given_up:
            return "the cluster of task processes is given up"
        return "" if self._client.status == "running" else "the connection to the scheduler is lost"

    def give_up(self) -> None:
        """Give this cluster up: the worker ends, and a new worker starts with a new cluster."""
        self._given_up = True

    async def where(self, futures: Sequence[Future[Any]]) -> Where:
        """Where tasks are, asked from the scheduler itself: this client may have missed messages."""
        keys = {future.key for future in futures}
        states = await cast(Any, self._client.scheduler).get_task_status(keys=list(keys))
        return Where(frozenset(await self._running(keys)), not _TO_RUN.intersection(states.values()))

    def cpu_s(self, addresses: frozenset[str]) -> float | None:
        """Processor time (s) that local task processes have used; None for a cluster elsewhere.

        On such a cluster Dask's scheduler drops processes that it has not heard from for five minutes.
        """
        if self._local is None:
            return None
        used = 0.0
        for nanny in self._nannies():
            if nanny.worker_address in addresses and nanny.pid:
                with suppress(psutil.Error):  # it has just died: Dask handles that
                    used += sum(psutil.Process(nanny.pid).cpu_times()[:2])
        return used

    def share(self) -> float:
        """Share of a core (0, 1] that a local process can count on: cores by what wanted them in the last minute."""
        return min(1.0, (psutil.cpu_count() or 1) / max(1.0, psutil.getloadavg()[0]))

    async def complete(self) -> bool:
        """True when every local task process is there, or the cluster is not ours."""
        return await self.threads() >= self._size

    async def replace(self, addresses: frozenset[str]) -> None:
        """Kill local task processes; new ones start, and Dask runs their tasks again."""
        for nanny in self._nannies():
            if nanny.worker_address in addresses:
                # Faster than restart_workers, which waits several seconds for a busy process to end by itself. The
                # nanny starts the next process in the background.
                with suppress(TimeoutError):  # it is killed; a loaded machine reports its end later
                    await nanny.kill(timeout=KILL_TIMEOUT_S)

    async def threads(self) -> int:
        """Number of tasks that can run at the same time now."""
        return sum((await self._client.nthreads()).values())

    def submit(
        self, function: Callable[..., Answer], *arguments: Any, key: str, job: str, priority: int = 0
    ) -> Future[Answer]:
        """Start ``function(*arguments, job, topic)`` as a task of the job ``job``.

        Dask runs the task again when its process dies, and gives up after ``allowed-failures`` deaths.
        """
        return self._client.submit(
            function, *arguments, job, self._topic, key=key, pure=False, retries=0, priority=priority
        )

    async def stop(self, job: str, futures: Sequence[Future[Any]], outcome: asyncio.Task[Any]) -> None:
        """End a job's tasks: ask them first, then replace their processes. Returns when they no longer compute."""
        keys = {future.key for future in futures}
        # Every process that has a task of the job, or may get one during the wait.
        addresses = await self._running(keys) if len(keys) == 1 else list(await self._client.nthreads())
        if addresses:
            asking = self._client.run(request_stop, job, workers=addresses, on_error="ignore")
            with suppress(
                TimeoutError, OSError
            ):  # a task that holds the GIL keeps its process from answering
                await asyncio.wait_for(asking, STOP_GRACE_S)
        await asyncio.wait({outcome}, timeout=STOP_GRACE_S if addresses else 0)
        if outcome.done():
            return
        addresses = await self._running(keys)
        for future in futures:
            await future.cancel()
        if self._local is None and addresses:
            await self._client.restart_workers(addresses, timeout=RESTART_TIMEOUT_S, raise_for_error=False)
        await self.replace(frozenset(addresses))

    async def leave(self, job: str, futures: Sequence[Future[Any]], outcome: asyncio.Task[Any]) -> None:
        """End the tasks of a job that another worker will run, as far as a short time allows."""
        if self._local is None:  # the embedded cluster ends with us
            with suppress(TimeoutError, OSError):
                await asyncio.wait_for(self.stop(job, futures, outcome), LEAVE_TIMEOUT_S)

    async def compile(self, part: str) -> None:
        """Compile one part of :data:`safestart.runtime.kernels.warmup.PARTS` in one of the processes; jobs go first."""
        await self._all([self._client.submit(warm, part, pure=False, priority=_LAST)])

    async def warm_all(self) -> None:
        """Bring all modules and kernels into every process, one after the other: the others stay free for jobs."""
        for address in list(await self._client.nthreads()):
            for work in (load, warm):
                await self._all([self._client.submit(work, workers=[address], pure=False, priority=_LAST)])

    async def _all(self, tasks: Sequence[Future[Any]]) -> None:
        for task in tasks:  # the client's gather would log stack traces when interrupted
            await cast(Awaitable[None], task.result())

    async def close(self) -> None:
        """End the embedded task processes at once, busy ones too; their jobs are back in the queue."""
        logging.getLogger("distributed.nanny").setLevel(logging.ERROR)  # we want it to kill
        closing = (nanny.close(timeout=KILL_TIMEOUT_S) for nanny in self._nannies())
        # A nanny that times out on a loaded machine may leave its process running; our own exit ends it.
        await asyncio.gather(*closing, return_exceptions=True)

    def _nannies(self) -> list[Nanny]:
        return [] if self._local is None else list(self._local.workers.values())

    async def _running(self, wanted: set[Any]) -> list[str]:
        processing = await self._client.processing()
        return [address for address, keys in processing.items() if wanted.intersection(keys)]
