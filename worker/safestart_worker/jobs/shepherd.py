"""Follow one claimed job on the cluster, from submission to its end in the database."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar
from uuid import uuid4

from distributed import KilledWorker
from distributed.client import FutureCancelledError

from safestart.errors import LeaseLost, NotFound, Unavailable
from safestart.processes.outcome import outcome_of
from safestart.processes.registry import process
from safestart.runtime.logs import about
from safestart.store.jobs.repository import JobRepository
from safestart.store.records import Claim
from safestart_worker import problems
from safestart_worker.cluster.cluster import Cluster
from safestart_worker.cluster.task import JobEnd
from safestart_worker.jobs.liveness import Finding, Signs
from safestart_worker.jobs.shards import Sharded
from safestart_worker.jobs.work import Journal, Whole, Work

log = logging.getLogger("safestart.worker")
Answer = TypeVar("Answer")

TICK_S = 0.25
WRITE_PERIOD_S = 0.5
# The renewal notices a dismissal, so it comes at least this often.
RENEW_PERIOD_S = 1.0
RETRY_S = 1.0


@dataclass(frozen=True, slots=True)
class Rules:
    """The settings of a shepherd."""

    lease_s: float
    max_attempts: int
    silence_s: float

    @property
    def renew_s(self) -> float:
        """Time between renewals."""
        return min(RENEW_PERIOD_S, self.lease_s / 4)


class Shepherd:
    """Watches one job: reports, renewals, time limit, dismissal, end."""

    def __init__(
        self,
        claim: Claim,
        jobs: JobRepository,
        cluster: Cluster,
        rules: Rules,
        on_over: Callable[[], None] = lambda: None,
    ) -> None:
        self.claim = claim
        self.key = f"job-{claim.job_id}-{claim.token}"
        self._jobs = jobs
        self._cluster = cluster
        self._rules = rules
        self._journal = Journal(claim.job_id)
        self._signs = Signs(cluster, rules.silence_s)
        self._work: Work | None = None
        self._shown = False
        self._on_over = on_over
        self.computes = True
        """False once the computation is over and only the job's end is being written."""

    def on_report(self, data: dict[str, Any]) -> None:
        """Handle a report of one of its tasks."""
        self._signs.heard()
        if self._work is not None:
            self._work.on_report(data)

    async def run(self, stopping: asyncio.Event) -> None:
        """Run the job to its end; give it back to the queue when ``stopping`` is set."""
        self._say(f"process {self.claim.process_id}, attempt {self.claim.attempt}")
        work = self._work = self._begin()
        outcome = asyncio.ensure_future(work.run())
        # A task that we ended on purpose ends with an error; retrieve it here, as nobody else does.
        outcome.add_done_callback(lambda task: task.cancelled() or task.exception())
        outcome.add_done_callback(self._over)
        try:
            await self._watch(work, outcome, stopping)
        except LeaseLost as lost:
            self._say(f"dropped: {lost.detail}", logging.WARNING)
            await work.stop(outcome)
        finally:
            work.forget()

    def _over(self, _: asyncio.Task[JobEnd]) -> None:
        self.computes = False
        self._on_over()

    def _begin(self) -> Work:
        try:
            spec = process(self.claim.process_id)
        except NotFound:
            spec = None  # the task says so
        most = self._rules.max_attempts
        if spec is not None and spec.sharding is not None:
            return Sharded(self.claim, self.key, self._cluster, self._journal, self._jobs, spec, most)
        return Whole(self.claim, self.key, self._cluster, self._journal, most)

    async def _watch(self, work: Work, outcome: asyncio.Task[JobEnd], stopping: asyncio.Event) -> None:
        start = time.monotonic()
        written = renewed = looked = start
        stop = asyncio.ensure_future(stopping.wait())
        try:
            while not outcome.done():
                await asyncio.wait({outcome, stop}, timeout=TICK_S, return_when=asyncio.FIRST_COMPLETED)
                now = time.monotonic()
                if outcome.done():
                    break
                if stopping.is_set():
                    await self._try(self._give_back)
                    return await work.leave(outcome)
                if self._journal.deaths and not await self._count_deaths():
                    await work.stop(outcome)
                    return await self._poisoned(work)
                if now - written >= WRITE_PERIOD_S:
                    written = now
                    await self._write_progress()
                if now - renewed >= self._rules.renew_s:
                    renewed = now
                    if await self._try(lambda: self._jobs.renew(self.claim, self._rules.lease_s)) is False:
                        self._say("dismissal asked for")
                        await work.stop(outcome)
                        return await self._end("dismissed", lambda: self._jobs.dismissed(self.claim))
                if now - looked >= self._signs.period_s:
                    looked = now
                    await self._look(work)
                if now - start > self.claim.timeout_s:
                    await work.stop(outcome)
                    return await self._fail(problems.of_timeout(self.claim.timeout_s))
        finally:
            stop.cancel()
        return await self._finish(work, outcome)

    async def _look(self, work: Work) -> None:
        """Restart a lost job in a new process, or on a new cluster when a new process does not help."""
        found = await self._signs.look(work.awaited())
        if found is Finding.ALIVE:
            return
        self._say(f"its tasks give no sign of life, {found.value}; starting again", logging.WARNING)
        self._signs.heard()
        if found is Finding.HUNG:
            await self._cluster.replace(self._signs.addresses)
        else:
            self._cluster.give_up()

    async def _finish(self, work: Work, outcome: asyncio.Task[JobEnd]) -> None:
        try:
            end = outcome.result()
        except KilledWorker:
            await self._count_deaths()
            return await self._poisoned(work)
        except LeaseLost:
            raise
        except (FutureCancelledError, asyncio.CancelledError):
            reason = "the cluster lost the task"
            return await self._end(reason, lambda: self._jobs.release(self.claim, reason))
        except Exception as error:
            incident = uuid4().hex
            log.exception("unexpected error %s on the cluster", incident, extra=about(job=self.claim.job_id))
            return await self._fail(problems.of_unexpected(error, incident))
        if end.trace:
            self._say(f"unexpected error {(end.problem or {}).get('id')}\n{end.trace}", logging.ERROR)
        if end.document is None:
            return await self._fail(end.problem or {})
        document = end.document
        if self._shown or self._journal.notes:  # a job that ended before its first report needs no last step
            await self._write_progress()
        said = await asyncio.to_thread(outcome_of, self.claim.process_id, document["outputs"])
        return await self._end(
            "successful", lambda: self._jobs.succeed(self.claim, document, end.artifacts, end.versions, said)
        )

    async def _count_deaths(self) -> bool:
        """Count the deaths of its task processes as attempts; False when no attempt is left."""
        most = self._rules.max_attempts
        while self._journal.deaths:
            left = await self._try(lambda: self._jobs.restarted(self.claim, most))
            if left is None:  # the database is unavailable: count when it is back
                return True
            self._journal.deaths -= 1
            if not left:
                return False
        return True

    async def _poisoned(self, work: Work) -> None:
        most = self._rules.max_attempts
        if not work.whole:
            return await self._fail(problems.of_poison(most))
        return await self._end("failed: too many attempts", lambda: self._jobs.poisoned(self.claim, most))

    async def _fail(self, problem: dict[str, Any]) -> None:
        await self._end(f"failed: {problem.get('detail')}", lambda: self._jobs.fail(self.claim, problem))

    def _give_back(self) -> None:
        self._jobs.release(self.claim, "its worker stopped; waits for the next one")
        self._say("back in the queue")

    async def _end(self, what: str, write: Callable[[], None]) -> None:
        """Write the end of the job; while the database is unavailable, retry until it is back or the lease is lost."""
        while True:
            try:
                await asyncio.to_thread(write)
            except Unavailable as error:
                self._say(f"cannot write its end ({what}) yet: {error.detail}", logging.WARNING)
                await asyncio.sleep(RETRY_S)
            else:
                return self._say(what)

    async def _write_progress(self) -> None:
        while self._journal.notes:
            note = self._journal.notes.pop(0)
            await self._try(partial(self._jobs.log, self.claim, note))
        fresh = self._journal.track.take()
        if fresh is not None:
            self._shown = True
            await self._try(partial(self._jobs.progress, self.claim, *fresh))

    async def _try(self, call: Callable[[], Answer]) -> Answer | None:
        """Call the store in a thread; a database outage does not end the computation."""
        try:
            return await asyncio.to_thread(call)
        except Unavailable as error:
            self._say(error.detail, logging.WARNING)
            return None

    def _say(self, text: str, level: int = logging.INFO) -> None:
        self._journal.say(text, level)
