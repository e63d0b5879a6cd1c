"""Signs of life of a job that reports nothing: a computation may be silent for long, a lost one stays silent for ever.

Looks at what cannot lie: processor time of the task processes, and what the scheduler says of the tasks.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from enum import Enum
from typing import Any

from distributed import Future

from safestart_worker.cluster.cluster import Cluster

# Share of one core below which a process does not compute. A waiting one takes 1 to 2 % for its event loop.
LEAST_SHARE = 0.04


class Finding(Enum):
    """What a look says of the tasks of a job."""

    ALIVE = "alive"
    HUNG = "their processes do nothing"
    DEAF = "they are over, and this worker has not heard of it"
    HOMELESS = "no task process is left to run them"


class Signs:
    """Watches one job; silent and lifeless for ``patience_s`` on end, it is found so."""

    def __init__(self, cluster: Cluster, patience_s: float) -> None:
        self._cluster = cluster
        self._patience_s = patience_s
        self._seen: tuple[Finding, frozenset[str]] | None = None
        self._since = self._cpu_s = 0.0
        self.addresses: frozenset[str] = frozenset()

    @property
    def period_s(self) -> float:
        """Time between looks."""
        return min(10.0, self._patience_s / 4)

    def heard(self) -> None:
        """A report has come: silence begins anew."""
        self._seen = None

    async def look(self, futures: Sequence[Future[Any]]) -> Finding:
        """What is the matter with the tasks that the job waits for, if it has been so for long enough."""
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
        busy = (cpu_s or 0.0) - self._cpu_s >= LEAST_SHARE * lasted
        waits_its_turn = kind is Finding.HOMELESS and await self._cluster.complete()
        if kind is Finding.ALIVE or (kind is Finding.HUNG and busy) or waits_its_turn:
            self.heard()
            return Finding.ALIVE
        self.addresses = where.processes
        return kind
