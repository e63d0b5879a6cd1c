"""What a worker does with the Dask cluster its jobs run on; ``opening`` starts or finds one."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar, cast

import psutil
from distributed import Client, Future, LocalCluster, Nanny

from safestart.runtime.warmup import PARTS, warm
from safestart_worker.cluster.task import load, request_stop

Answer = TypeVar("Answer")

# How long a task that polls gets to stop by itself, and how long a replaced process may take to come back.
STOP_GRACE_S = 2.0
RESTART_TIMEOUT_S = 30.0
# What a stopping worker spends at most on its tasks on a cluster that stays.
LEAVE_TIMEOUT_S = 4.0
# How long a local process that must go gets before it is killed.
KILL_TIMEOUT_S = 0.5
# States of a task that still has to run; in every other one it is over for the scheduler.
_TO_RUN = frozenset({"waiting", "no-worker", "queued", "processing"})


@dataclass(frozen=True, slots=True)
class Where:
    """Processes that run some tasks now, by address; ``over``: the scheduler has none of them to run any more."""

    processes: frozenset[str]
    over: bool


class Cluster:
    """A Dask client and what this worker does with it."""

    def __init__(self, client: Client, owner: str, local: LocalCluster | None) -> None:
        self._client = client
        self._topic = f"safestart-{owner}"
        self._local = local
        self._size = 0 if local is None else len(local.workers)
        self._given_up = False

    @property
    def embedded(self) -> bool:
        """True when the task processes are this worker's own."""
        return self._local is not None

    def listen(self, handler: Callable[[dict[str, Any]], None]) -> None:
        """Hand every report of our tasks to ``handler``."""
        self._client.subscribe_topic(self._topic, lambda event: handler(event[1]))

    @property
    def lost(self) -> str:
        """Why this cluster is of no use any more; empty while it is."""
        if self._given_up:
            return "the cluster of task processes is given up"
        return "" if self._client.status == "running" else "the connection to the scheduler is lost"

    def give_up(self) -> None:
        """Do not use this cluster any more: the worker ends, and a new one starts with a new cluster."""
        self._given_up = True

    async def where(self, futures: Sequence[Future[Any]]) -> Where:
        """Where tasks are, by the scheduler's word and not by what this client has heard."""
        keys = {future.key for future in futures}
        states = await cast(Any, self._client.scheduler).get_task_status(keys=list(keys))
        return Where(frozenset(await self._running(keys)), not _TO_RUN.intersection(states.values()))

    def cpu_s(self, addresses: frozenset[str]) -> float | None:
        """Processor time (s) that local task processes have used; None for a cluster elsewhere.

        There Dask's scheduler itself drops processes it has not heard of for five minutes.
        """
        if self._local is None:
            return None
        used = 0.0
        for nanny in self._nannies():
            if nanny.worker_address in addresses and nanny.pid:
                with suppress(psutil.Error):  # it has just died: Dask sees to that
                    used += sum(psutil.Process(nanny.pid).cpu_times()[:2])
        return used

    async def complete(self) -> bool:
        """True when every local task process is there, or the cluster is not ours."""
        return await self.threads() >= self._size

    async def replace(self, addresses: frozenset[str]) -> None:
        """Kill local task processes; new ones start, and Dask runs their tasks again."""
        for nanny in self._nannies():
            if nanny.worker_address in addresses:
                # Sooner than restart_workers, which waits several seconds for a busy process to end by itself; the
                # nanny starts the next process in the background.
                with suppress(TimeoutError):  # killed it is; on a loaded machine its end is seen later
                    await nanny.kill(timeout=KILL_TIMEOUT_S)

    async def threads(self) -> int:
        """Number of tasks that can run at once now."""
        return sum((await self._client.nthreads()).values())

    def submit(
        self, function: Callable[..., Answer], *arguments: Any, key: str, job: str, priority: int = 0
    ) -> Future[Answer]:
        """Start ``function(*arguments, job, topic)`` as a task of the job ``job``.

        Dask runs it again if its process dies, and gives up after allowed-failures deaths.
        """
        return self._client.submit(
            function, *arguments, job, self._topic, key=key, pure=False, retries=0, priority=priority
        )

    async def stop(self, job: str, futures: Sequence[Future[Any]], outcome: asyncio.Task[Any]) -> None:
        """End a job's tasks: ask first, then replace their processes. Returns when they no longer compute."""
        keys = {future.key for future in futures}
        # Every process that has a task of the job, or may get one before the wait is over.
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
        """End the tasks of a job that somebody else will run, as far as that goes in a short time."""
        if self._local is None:  # the embedded cluster ends with us
            with suppress(TimeoutError, OSError):
                await asyncio.wait_for(self.stop(job, futures, outcome), LEAVE_TIMEOUT_S)

    async def warm_up(self, say: Callable[[str], None]) -> None:
        """Load the processes everywhere; compile each part somewhere and say which is done; then warm all of them."""
        addresses = list(await self._client.nthreads())
        await self._all([self._client.submit(load, workers=[a], pure=False) for a in addresses])

        async def compiled(part: str) -> None:
            await self._all([self._client.submit(warm, part, pure=False)])
            say(part)

        await asyncio.gather(*map(compiled, PARTS))
        await self._all([self._client.submit(warm, workers=[a], pure=False) for a in addresses])

    async def _all(self, tasks: Sequence[Future[Any]]) -> None:
        for task in tasks:  # not the client's gather: it logs stack traces when it is interrupted
            await cast(Awaitable[None], task.result())

    async def close(self) -> None:
        """End the embedded task processes at once, busy ones too: their jobs are back in the queue."""
        logging.getLogger("distributed.nanny").setLevel(logging.ERROR)  # that it must kill is what we ask for
        closing = (nanny.close(timeout=KILL_TIMEOUT_S) for nanny in self._nannies())
        # One that does not see its process end in time (a loaded machine) leaves it to our own end, which ends it too.
        await asyncio.gather(*closing, return_exceptions=True)

    def _nannies(self) -> list[Nanny]:
        return [] if self._local is None else list(self._local.workers.values())

    async def _running(self, wanted: set[Any]) -> list[str]:
        processing = await self._client.processing()
        return [address for address, keys in processing.items() if wanted.intersection(keys)]
