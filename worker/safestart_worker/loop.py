"""The worker sends heartbeats, claims as many jobs as can run, and gives each a shepherd, until told to stop."""

from __future__ import annotations

import asyncio
import logging
import os
import secrets
import signal
import socket
import time
from contextlib import suppress
from dataclasses import dataclass

from safestart.errors import Away, Unavailable
from safestart.runtime.logs import about
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.retention import Retention
from safestart_worker.cluster.cluster import Cluster
from safestart_worker.cluster.opening import open_cluster
from safestart_worker.jobs.shepherd import Rules, Shepherd
from safestart_worker.warming import Kernels

log = logging.getLogger("safestart.worker")

HEARTBEAT_S = 3.0
# Time between retries while the database is unavailable.
AWAY_S = 2.0
PURGE_S = 3600.0


@dataclass(frozen=True, slots=True)
class Options:
    """Options of a worker.

    ``processes`` 0: as many as the cluster has threads. ``keep_s`` 0: keep ended jobs for ever.
    """

    database_url: str
    scheduler: str
    processes: int
    lease_s: float
    poll_s: float
    max_attempts: int
    silence_s: float
    keep_s: float = 0.0
    warm_up: str = "all"

    @property
    def rules(self) -> Rules:
        """The options that the shepherds need."""
        return Rules(self.lease_s, self.max_attempts, self.silence_s)


class Worker:
    """Claims jobs and runs them to their ends."""

    def __init__(
        self,
        options: Options,
        jobs: JobRepository,
        cluster: Cluster,
        owner: str,
        kernels: Kernels | None = None,
    ) -> None:
        self._options = options
        self._jobs = jobs
        self._cluster = cluster
        self._owner = owner
        self._capacity = 0
        self._last_beat = 0.0
        self._likely = False  # the last claim found a job, so the next one probably will
        self._herd: dict[asyncio.Task[None], Shepherd] = {}
        self._freed = asyncio.Event()
        self._kernels = kernels or Kernels(cluster, parts=())
        self._kernels.on_change = self._freed.set
        cluster.listen(self._on_report)

    async def run(self, stopping: asyncio.Event) -> None:
        """Work until ``stopping`` is set; running jobs then go back to the queue."""
        stop = asyncio.ensure_future(stopping.wait())
        while not stopping.is_set():
            pause = self._options.poll_s
            try:
                await self._beat()
                await self._claim(stopping)
                self._kernels.go_on(self._capacity - self._busy)
            except Unavailable as error:
                log.warning("%s", error.detail)
                pause = AWAY_S
            except OSError as error:  # Dask's errors of communication are OSErrors
                log.warning("%s", error)
            if self._cluster.lost:
                log.error("%s", self._cluster.lost)
                break
            if self._kernels.failed:
                break
            freed = asyncio.ensure_future(self._freed.wait())
            await asyncio.wait({stop, freed}, timeout=pause, return_when=asyncio.FIRST_COMPLETED)
            freed.cancel()
            self._freed.clear()
            self._collect()
        stopping.set()
        stop.cancel()
        if self._herd:
            await asyncio.wait(self._herd)
            self._collect()

    @property
    def _busy(self) -> int:
        """Jobs that compute. A job whose end is being written no longer counts, so the next one can start."""
        return sum(shepherd.computes for shepherd in self._herd.values())

    async def _claim(self, stopping: asyncio.Event) -> None:
        options = self._options
        # At most one unwritten end per place, in case the database accepts claims but no results.
        while self._busy < self._capacity and len(self._herd) < 2 * self._capacity and not stopping.is_set():
            if not await self._compiled():
                return
            claim = await asyncio.to_thread(
                self._jobs.claim, self._owner, options.lease_s, options.max_attempts, likely=self._likely
            )
            self._likely = claim is not None
            if claim is None:
                return
            shepherd = Shepherd(claim, self._jobs, self._cluster, options.rules, self._freed.set)
            task = asyncio.create_task(shepherd.run(stopping))
            task.add_done_callback(lambda _: self._freed.set())
            self._herd[task] = shepherd

    async def _compiled(self) -> bool:
        """Whether the next job's kernels are there; if not, they are compiled next."""
        if self._kernels.over:
            return True
        process_id = await asyncio.to_thread(self._jobs.next_process)
        return process_id is None or self._kernels.there(process_id)

    async def _beat(self) -> None:
        """Say that this worker is alive, and see how many jobs the cluster can run."""
        now = time.monotonic()
        if now - self._last_beat < HEARTBEAT_S:
            return
        threads = await self._cluster.threads()
        # The embedded size is fixed: a replaced process comes back before the queue notices.
        wanted = self._options.processes
        self._capacity = wanted if self._cluster.embedded else min(threads, wanted or threads)
        await asyncio.to_thread(self._jobs.heartbeat, self._owner, self._capacity, self._busy)
        self._last_beat = now

    def _collect(self) -> None:
        for task in [task for task in self._herd if task.done()]:
            shepherd = self._herd.pop(task)
            error = task.exception()
            if error is not None:
                # Its lease runs out, and a worker takes the job over.
                log.error("left to its lease", exc_info=error, extra=about(job=shepherd.claim.job_id))

    def _on_report(self, data: dict[str, object]) -> None:
        for shepherd in self._herd.values():
            if shepherd.key == data["key"]:
                shepherd.on_report(data)


async def work(options: Options) -> int:
    """Run a worker until SIGTERM or SIGINT; returns the exit code."""
    stopping = asyncio.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(number, stopping.set)
    owner = f"{socket.gethostname()}-{os.getpid()}-{secrets.token_hex(3)}"
    database = Database(options.database_url)
    if not await _migrated(database, stopping):
        return 0
    jobs = JobRepository(database)
    start = time.monotonic()
    lost = False
    announcing = asyncio.create_task(_announce(jobs, owner))
    async with open_cluster(options.scheduler, options.processes, options.max_attempts, owner) as cluster:
        where = options.scheduler or f"{options.processes} task processes"
        log.info("%s on %s, cluster ready in %.1f s", owner, where, time.monotonic() - start)
        kernels = Kernels(cluster, ahead=options.warm_up == "all")
        announcing.cancel()
        if not stopping.is_set():
            log.info("takes jobs from %s", database.shown)
            purging = asyncio.create_task(_purge(Retention(database), options.keep_s))
            await Worker(options, jobs, cluster, owner, kernels).run(stopping)
            purging.cancel()
            kernels.stop()
        lost = bool(cluster.lost) or kernels.failed
        await _say_goodbye(jobs, owner)
        log.info("stopping")
    database.close()
    return 1 if lost else 0


async def _migrated(database: Database, stopping: asyncio.Event) -> bool:
    """Wait for an unavailable database; False when told to stop meanwhile. Raises when waiting cannot help."""
    while not stopping.is_set():
        try:
            await asyncio.to_thread(database.migrate)
        except Away as error:
            log.warning("waits for the database: %s", error.detail)
            with suppress(TimeoutError):
                await asyncio.wait_for(stopping.wait(), AWAY_S)
        else:
            return True
    return False


async def _purge(retention: Retention, keep_s: float) -> None:
    """Once an hour, delete jobs that ended longer ago than ``keep_s``."""
    while keep_s > 0.0:
        try:
            number = await asyncio.to_thread(retention.purge, keep_s)
        except Unavailable as error:
            log.warning("%s", error.detail)
        else:
            if number:
                log.info("deleted %d jobs that ended more than %g days ago", number, keep_s / 86_400.0)
        await asyncio.sleep(PURGE_S)


async def _announce(jobs: JobRepository, owner: str) -> None:
    """Send heartbeats with no room while the cluster starts, so that the service shows waiting jobs a worker."""
    while True:
        try:
            await asyncio.to_thread(jobs.heartbeat, owner, 0, 0)
        except Unavailable as error:
            log.warning("%s", error.detail)
        await asyncio.sleep(HEARTBEAT_S)


async def _say_goodbye(jobs: JobRepository, owner: str) -> None:
    try:
        await asyncio.to_thread(jobs.farewell, owner)
    except Unavailable as error:
        log.warning("%s", error.detail)
