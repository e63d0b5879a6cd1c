"""One claimed job on the cluster, from submission to its end in the database."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar, cast
from uuid import uuid4

from distributed import Future, KilledWorker
from distributed.client import FutureCancelledError

from safestart.errors import LeaseLost, Unavailable
from safestart.store.jobs import JobRepository
from safestart.store.records import Claim
from safestart_worker import problems
from safestart_worker.cluster import Cluster
from safestart_worker.task import Outcome
from safestart_worker.track import Track

log = logging.getLogger("safestart.worker")
Answer = TypeVar("Answer")

TICK_S = 0.25
WRITE_PERIOD_S = 0.5
# A dismissal is noticed with the renewal, so that comes at least this often.
RENEW_PERIOD_S = 1.0
RETRY_S = 1.0


@dataclass(frozen=True, slots=True)
class Rules:
    """The settings a shepherd keeps to."""

    lease_s: float
    max_attempts: int

    @property
    def renew_s(self) -> float:
        """Time between renewals."""
        return min(RENEW_PERIOD_S, self.lease_s / 4)


class Shepherd:
    """Watches one job: reports, renewals, time limit, dismissal, end."""

    def __init__(self, claim: Claim, jobs: JobRepository, cluster: Cluster, rules: Rules) -> None:
        self.claim = claim
        self.key = f"job-{claim.job_id}-{claim.token}"
        self._jobs = jobs
        self._cluster = cluster
        self._rules = rules
        self._track = Track()
        self._starts = 0
        self._notes: list[str] = []

    def on_report(self, data: dict[str, Any]) -> None:
        """Take in a report of the task."""
        if data["kind"] == "started":
            self._starts += 1
            if self._starts > 1:
                self._track.restart()
                self._notes.append(f"its task process was lost; running again (start {self._starts})")
            self._say(f"runs in process {data['pid']} at {data['address']}")
        else:
            self._track.update(data["done"], data["total"], data["elapsed_s"], data["message"])

    async def run(self, stopping: asyncio.Event) -> None:
        """Run the job to its end; when ``stopping`` is set, give it back to the queue."""
        self._say(f"process {self.claim.process_id}, attempt {self.claim.attempt}")
        future = self._cluster.submit(self.claim, self.key)
        # The client is asynchronous, and so is its result; Dask's annotations know only the other kind.
        outcome = asyncio.ensure_future(cast(Awaitable[Outcome], future.result()))
        try:
            await self._watch(future, outcome, stopping)
        except LeaseLost as lost:
            self._say(f"dropped: {lost.detail}", logging.WARNING)
            await self._cluster.stop(future, outcome)
        finally:
            outcome.cancel()
            future.release()

    async def _watch(
        self, future: Future[Outcome], outcome: asyncio.Task[Outcome], stopping: asyncio.Event
    ) -> None:
        start = time.monotonic()
        written = renewed = start
        stop = asyncio.ensure_future(stopping.wait())
        try:
            while not outcome.done():
                await asyncio.wait({outcome, stop}, timeout=TICK_S, return_when=asyncio.FIRST_COMPLETED)
                now = time.monotonic()
                if outcome.done():
                    break
                if stopping.is_set():
                    await self._try(self._give_back)
                    return await self._cluster.leave(future, outcome)
                if now - written >= WRITE_PERIOD_S:
                    written = now
                    await self._write_progress()
                if now - renewed >= self._rules.renew_s:
                    renewed = now
                    if await self._try(lambda: self._jobs.renew(self.claim, self._rules.lease_s)) is False:
                        self._say("dismissal asked for")
                        await self._cluster.stop(future, outcome)
                        return await self._end("dismissed", lambda: self._jobs.dismissed(self.claim))
                if now - start > self.claim.timeout_s:
                    await self._cluster.stop(future, outcome)
                    return await self._fail(problems.of_timeout(self.claim.timeout_s))
        finally:
            stop.cancel()
        return await self._finish(outcome)

    async def _finish(self, outcome: asyncio.Task[Outcome]) -> None:
        try:
            end = outcome.result()
        except KilledWorker:
            return await self._fail(problems.of_poison(self._rules.max_attempts))
        except (FutureCancelledError, asyncio.CancelledError):
            reason = "the cluster lost the task"
            return await self._end(reason, lambda: self._jobs.release(self.claim, reason))
        except Exception as error:
            incident = uuid4().hex
            log.exception("job=%s unexpected error %s on the cluster", self.claim.job_id, incident)
            return await self._fail(problems.of_unexpected(error, incident))
        if end.trace:
            self._say(f"unexpected error {(end.problem or {}).get('id')}\n{end.trace}", logging.ERROR)
        if end.document is None:
            return await self._fail(end.problem or {})
        document = end.document
        await self._write_progress()
        return await self._end(
            "successful", lambda: self._jobs.succeed(self.claim, document, end.artifacts, end.versions)
        )

    async def _fail(self, problem: dict[str, Any]) -> None:
        await self._end(f"failed: {problem.get('detail')}", lambda: self._jobs.fail(self.claim, problem))

    def _give_back(self) -> None:
        self._jobs.release(self.claim, "its worker stopped; waits for the next one")
        self._say("back in the queue")

    async def _end(self, what: str, write: Callable[[], None]) -> None:
        """Write the end of the job; while the database is away, try until it is back or the lease is lost."""
        while True:
            try:
                await asyncio.to_thread(write)
            except Unavailable as error:
                self._say(f"cannot write its end ({what}) yet: {error.detail}", logging.WARNING)
                await asyncio.sleep(RETRY_S)
            else:
                return self._say(what)

    async def _write_progress(self) -> None:
        while self._notes:
            note = self._notes.pop(0)
            await self._try(partial(self._jobs.log, self.claim, note))
        fresh = self._track.take()
        if fresh is not None:
            await self._try(partial(self._jobs.progress, self.claim, *fresh))

    async def _try(self, call: Callable[[], Answer]) -> Answer | None:
        """Call the store in a thread; a database that is away for a while does not end the computation."""
        try:
            return await asyncio.to_thread(call)
        except Unavailable as error:
            self._say(error.detail, logging.WARNING)
            return None

    def _say(self, text: str, level: int = logging.INFO) -> None:
        log.log(level, "job=%s %s", self.claim.job_id, text)
