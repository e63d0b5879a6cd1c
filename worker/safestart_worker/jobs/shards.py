"""A sharded job on the cluster: a window of shards, each stored as it ends, then the merge.

Shards that a lost worker stored are reused, unless other code computed them. One source computes the whole job, the
one that its provenance names.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections import deque
from collections.abc import Callable, Coroutine
from datetime import UTC, datetime
from typing import Any, TypeVar

from distributed import Future

from safestart.errors import Cancelled, SafestartError, Unavailable
from safestart.processes.base import ProcessSpec
from safestart.processes.sharding import Part, content
from safestart.records.provenance import source
from safestart.store.jobs.repository import JobRepository
from safestart.store.records import Claim
from safestart_worker import problems
from safestart_worker.cluster.cluster import Cluster
from safestart_worker.cluster.task import JobEnd, ShardEnd, run_merge, run_shard
from safestart_worker.jobs.work import Journal, spared

Answer = TypeVar("Answer")

RETRY_S = 1.0
# Shards queued on the cluster per thread, so that no thread idles. Jobs of one task go first.
_AHEAD, _PRIORITY = 2, -1


class Sharded:
    """A job of many tasks."""

    whole = False

    def __init__(
        self,
        claim: Claim,
        key: str,
        cluster: Cluster,
        journal: Journal,
        jobs: JobRepository,
        spec: ProcessSpec,
        most: int,
    ) -> None:
        assert spec.sharding is not None
        self._claim, self._key, self._cluster, self._journal = claim, key, cluster, journal
        self._jobs, self._spec, self._sharding = jobs, spec, spec.sharding
        self._most = most
        self._started = datetime.now(UTC)
        self._begin = time.monotonic()
        self._ending = self._storing = False
        self._futures: dict[int, Future[Any]] = {}
        self._starts: dict[int, int] = {}
        self._shares: dict[int, float] = {}
        self._processes: set[int] = set()
        self._done = self._total = 0

    async def run(self) -> JobEnd:
        """Run the missing shards, then the merge."""
        try:
            parts = self._sharding.parts(self._spec.stored(self._claim.inputs))
        except SafestartError as error:
            return _failed(problems.of_error(error))
        contents = [content(self._spec.id, part, source()) for part in parts]
        kept = await self._store(lambda: self._jobs.shard_contents(self._claim.job_id))
        missing = [number for number, wanted in enumerate(contents) if kept.get(number) != wanted]
        self._total, self._done = len(parts), len(parts) - len(missing)
        if self._done:
            self._journal.notes.append(f"{self._done} of {self._total} parts are done already")
            self._journal.track.found = self._done / (self._total + 1)
        return await self._shards(parts, contents, deque(missing)) or await self._merge()

    async def _shards(
        self, parts: list[dict[str, Any]], contents: list[str], missing: deque[int]
    ) -> JobEnd | None:
        """Run the missing shards; returns None when the store has all, or the job's outcome when one failed."""
        window = _AHEAD * max(1, await self._cluster.threads())
        waiting: dict[asyncio.Future[ShardEnd], int] = {}
        while waiting or (missing and not self._ending):
            while missing and len(waiting) < window and not self._ending:
                number = missing.popleft()
                run = self._run(number, run_shard, self._claim.process_id, parts[number], number)
                result = asyncio.ensure_future(run)
                result.add_done_callback(lambda task: task.cancelled() or task.exception())
                waiting[result] = number
            ended, _ = await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
            finished: dict[int, Part] = {}
            failed = None
            for task in ended:
                number = waiting.pop(task)
                end = task.result()
                self._futures.pop(number).release()
                if end.by != source():
                    failed = _failed(problems.of_other_source(source(), end.by))
                elif end.part is None:
                    failed = _failed(end.problem or {}, end.trace)
                else:
                    finished[number] = end.part
            if finished:
                await self._keep(finished, contents)
            if failed is not None:
                self._ending = True
                return failed
        return None

    async def _keep(self, finished: dict[int, Part], contents: list[str]) -> None:
        """All that ended while the store worked: the more cores there are, the more go into one transaction."""
        rows = [(number, contents[number], part.document, part.data) for number, part in finished.items()]
        await self._store(lambda: self._jobs.save_shards(self._claim, rows))
        for number in finished:
            self._shares.pop(number, None)
        self._done += len(finished)
        self._show(f"{self._done} of {self._total} parts")

    async def _merge(self) -> JobEnd:
        claim = self._claim
        if self._ending:
            return _failed(problems.of_error(Cancelled("the job was ended before its merge")))
        kept = await self._store(lambda: self._jobs.shards(claim.job_id))
        parts = [Part(shard.document, shard.data) for shard in kept[: self._total]]
        inputs = (claim.process_id, claim.inputs, parts, self._started)
        outcome = await self._run(self._total, run_merge, *inputs)
        by = outcome.versions["source_sha256"]
        return outcome if by == source() else _failed(problems.of_other_source(source(), by))

    def _run(
        self, number: int, function: Callable[..., Answer], *arguments: Any
    ) -> Coroutine[Any, Any, Answer]:
        """Submit a task now; returns a coroutine that waits for its result."""

        def submit(again: int) -> Future[Answer]:
            key = f"{self._key}-{number}" + (f"-again-{again}" if again else "")
            future = self._cluster.submit(function, *arguments, key=key, job=self._key, priority=_PRIORITY)
            self._futures[number] = future
            return future

        return spared(submit(0), submit, lambda: self._starts.get(number, 0), self._most)

    async def _store(self, call: Callable[[], Answer]) -> Answer:
        """Call the store; while the database is unavailable, retry until it is back or the lease is lost."""
        self._storing = True
        try:
            while True:
                try:
                    return await asyncio.to_thread(call)
                except Unavailable as error:
                    if self._ending:
                        raise
                    self._journal.say(error.detail, logging.WARNING)
                    await asyncio.sleep(RETRY_S)
        finally:
            self._storing = False

    def awaited(self) -> list[Future[Any]]:
        """The running shards, or the merge; none during calls to the store."""
        return [] if self._storing else list(self._futures.values())

    def on_report(self, data: dict[str, Any]) -> None:
        """Follow the progress of all shards; the merge counts as one more."""
        number = int(data.get("shard", self._total))
        if data["kind"] == "started":
            starts = self._starts[number] = self._starts.get(number, 0) + 1
            if starts > 1:
                which = f"shard {number + 1}" if number < self._total else "the merge"
                self._journal.notes.append(f"a task process was lost; {which} runs again (start {starts})")
            if data["pid"] not in self._processes:
                self._processes.add(data["pid"])
                self._journal.say(f"runs in process {data['pid']} at {data['address']}")
            self._shares[number] = 0.0
        elif number in self._shares:
            self._shares[number] = data["done"] / data["total"] if data["total"] > 0 else 0.0
            self._show(data["message"] if number == self._total else f"{self._done} of {self._total} parts")

    def _show(self, message: str) -> None:
        done = self._done + sum(self._shares.values())
        self._journal.track.update(done, self._total + 1, time.monotonic() - self._begin, message)

    async def stop(self, outcome: asyncio.Task[JobEnd]) -> None:
        """End every task."""
        self._ending = True
        await self._cluster.stop(self._key, list(self._futures.values()), outcome)

    async def leave(self, outcome: asyncio.Task[JobEnd]) -> None:
        """End every task if the cluster stays; the store keeps the finished shards."""
        self._ending = True
        await self._cluster.leave(self._key, list(self._futures.values()), outcome)

    def forget(self) -> None:
        """Release every task."""
        self._ending = True
        for future in self._futures.values():
            future.release()


def _failed(problem: dict[str, Any], trace: str | None = None) -> JobEnd:
    return JobEnd(None, (), {}, problem, trace)
