"""Send progress out of a task process: at most a few events per second, over Dask's event topics."""

from __future__ import annotations

import os
import time
from typing import Any

from distributed import Worker

PERIOD_S = 0.2


class Reporter:
    """Sends the units of work done by a task of the job ``key``; drops reports that come faster than ``PERIOD_S``."""

    def __init__(self, key: str, topic: str, worker: Worker, shard: int | None = None) -> None:
        self._about = {"key": key} if shard is None else {"key": key, "shard": shard}
        self._topic = topic
        self._worker = worker
        self._start = time.monotonic()
        self._last = -PERIOD_S

    def started(self) -> None:
        """Report that the task begins; a second report for the same key means that its first process was lost."""
        self._send({"kind": "started", "pid": os.getpid(), "address": self._worker.address})

    def report(self, done: float, total: float, message: str) -> None:
        """Send the units done and the units in total."""
        elapsed = time.monotonic() - self._start
        if elapsed - self._last < PERIOD_S and done < total:
            return
        self._last = elapsed
        self._send(
            {
                "kind": "progress",
                "done": float(done),
                "total": float(total),
                "elapsed_s": elapsed,
                "message": message,
            }
        )

    def _send(self, data: dict[str, Any]) -> None:
        self._worker.log_event(self._topic, {**self._about, **data})
