"""Signs of life of a silent job.

A healthy computation may report nothing for a long time; a lost one never reports again. The processor time of the
task processes and the scheduler's view of the tasks tell them apart.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from enum import Enum
from typing import Any

from distributed import Future

from safestart_worker.cluster.cluster import Cluster

# A process that uses less than this share of a core that it can have does not compute; its idle event loop takes 1
# to 2 %. On a crowded machine one that computes gets far less than a core.
LEAST_SHARE = 0.04


class Finding(Enum):
    """What one check finds about the tasks of a job."""

    ALIVE = "alive"
    HUNG = "their processes do nothing"
    DEAF = "they have ended, but this worker has no report of it"
    HOMELESS = "no task process is left to run them"


class Signs:
    """Watches one job and reports it lost after ``patience_s`` of silence without signs of life."""

    def __init__(self, cluster: Cluster, patience_s: float) -> None:
        self._cluster = cluster
        self._patience_s = patience_s
        self._seen: tuple[Finding, frozenset[str]] | None = None
        self._since = self._cpu_s = 0.0
        self.addresses: frozenset[str] = frozenset()

    @property
    def period_s(self) -> float:
        """Time between checks."""
        return min(10.0, self._patience_s / 4)

    def heard(self) -> None:
        """Note a report: the silence starts again from zero."""
        self._seen = None

    async def look(self, futures: Sequence[Future[Any]]) -> Finding:
        """What is wrong with the tasks that the job waits for, once it has lasted long enough."""
        if not futures:
            self.heard()
            return Finding.ALIVE
        where = await self._cluster.where(futures)
        cpu_s = self._cluster.cpu_s(where.processes)
        if where.processes:
            kind = Finding.ALIVE if cpu_s is None else Finding.HUNG
        else:
            kind = Finding.DEAF if where.over else Finding.HOMELESS
        now = time.monotonic()
        if self._seen != (kind, where.processes):
            self._seen, self._since, self._cpu_s = (kind, where.processes), now, cpu_s or 0.0
        lasted = now - self._since
        if lasted < self._patience_s:
            return Finding.ALIVE
        busy = (cpu_s or 0.0) - self._cpu_s >= LEAST_SHARE * self._cluster.share() * lasted
        waits_its_turn = kind is Finding.HOMELESS and await self._cluster.complete()
        if kind is Finding.ALIVE or (kind is Finding.HUNG and busy) or waits_its_turn:
            self.heard()
            return Finding.ALIVE
        self.addresses = where.processes
        return kind
