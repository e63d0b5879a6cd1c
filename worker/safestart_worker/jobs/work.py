"""A claimed job as work on the cluster. This file has jobs of one task; ``shards`` has jobs of many."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Sequence
from typing import Any, Protocol, TypeVar, cast

from distributed import Future, KilledWorker

from safestart.runtime.logs import about
from safestart.store.records import Claim
from safestart_worker.cluster.cluster import Cluster
from safestart_worker.cluster.task import JobEnd, run_job
from safestart_worker.jobs.track import Track

log = logging.getLogger("safestart.worker")
Answer = TypeVar("Answer")


class Journal:
    """The state of a running job: progress, deaths of its process, notes for its events, lines for the log."""

    def __init__(self, job_id: str) -> None:
        self.job_id = job_id
        self.track = Track()
        self.notes: list[str] = []
        self.deaths = 0

    def say(self, text: str, level: int = logging.INFO) -> None:
        """Log one line about the job."""
        log.log(level, "%s", text, extra=about(job=self.job_id))


class Work(Protocol):
    """The work that a shepherd follows; ``outcome`` is the asyncio task that runs :meth:`run`.

    ``whole``: the job is one task, so the death of its process costs the job an attempt.
    """

    whole: bool

    async def run(self) -> JobEnd:
        """Run to the outcome; does not catch errors of Dask and of the store."""
        ...

    def on_report(self, data: dict[str, Any]) -> None:
        """Handle a report of one of the tasks."""
        ...

    def awaited(self) -> Sequence[Future[Any]]:
        """The tasks that :meth:`run` waits for now; none while it waits for something else."""
        ...

    async def stop(self, outcome: asyncio.Task[JobEnd]) -> None:
        """End the computation; returns when it no longer computes."""
        ...

    async def leave(self, outcome: asyncio.Task[JobEnd]) -> None:
        """End it as far as a short time allows: another worker will run the job."""
        ...

    def forget(self) -> None:
        """Release every task, so that :meth:`run` ends by itself.

        Cancelling :meth:`run` would harm other jobs: one coroutine of Dask's client gathers results for all
        waiters, and cancelling one waiter cancels it for all.
        """
        ...


async def spared(
    future: Future[Answer], again: Callable[[int], Future[Answer]], starts: Callable[[], int], most: int
) -> Answer:
    """Result of a task; calls ``again`` to submit it anew when Dask gives it up for deaths that it did not cause.

    Dask blames the death of a process on all tasks assigned to it, those that only waited too. The task's own
    deaths are its unfinished ``starts``, at most ``most``. A task that kills its process before it can report a
    start gets ``most`` submissions.
    """
    for submissions in range(1, most + 1):
        try:
            # The client is asynchronous, so its result is too; Dask's annotations know only the synchronous kind.
            return await cast(Awaitable[Answer], future.result())
        except KilledWorker:
            if submissions == most or starts() >= most:
                raise
            future = again(submissions)
    raise AssertionError("a task is submitted at least once")


class Whole:
    """A job of one task."""

    whole = True

    def __init__(self, claim: Claim, key: str, cluster: Cluster, journal: Journal, most: int) -> None:
        self._claim, self._cluster, self._key, self._journal, self._most = claim, cluster, key, journal, most
        self._starts = 0
        self._future = self._submit(key)

    async def run(self) -> JobEnd:
        """Wait for the task."""
        return await spared(
            self._future, lambda n: self._submit(f"{self._key}-again-{n}"), lambda: self._starts, self._most
        )

    def _submit(self, key: str) -> Future[JobEnd]:
        inputs = (self._claim.process_id, self._claim.inputs)
        self._future = self._cluster.submit(run_job, *inputs, key=key, job=self._key)
        return self._future

    def on_report(self, data: dict[str, Any]) -> None:
        """Follow the progress; a second start means that the first process was lost."""
        journal = self._journal
        if data["kind"] == "started":
            self._starts += 1
            if self._starts > 1:
                journal.track.restart()
                journal.deaths += 1
            journal.say(f"runs in process {data['pid']} at {data['address']}")
        else:
            journal.track.update(data["done"], data["total"], data["elapsed_s"], data["message"])

    def awaited(self) -> Sequence[Future[Any]]:
        """The task."""
        return [self._future]

    async def stop(self, outcome: asyncio.Task[JobEnd]) -> None:
        """End the task."""
        await self._cluster.stop(self._key, [self._future], outcome)

    async def leave(self, outcome: asyncio.Task[JobEnd]) -> None:
        """End the task if the cluster stays."""
        await self._cluster.leave(self._key, [self._future], outcome)

    def forget(self) -> None:
        """Release the task."""
        self._future.release()
