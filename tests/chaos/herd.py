"""Claimers in separate processes, and the properties that must hold whatever happens to them."""

from __future__ import annotations

import multiprocessing
import os
import random
import signal
import time
from collections.abc import Callable
from multiprocessing.context import ForkProcess
from pathlib import Path
from typing import Any

from sqlalchemy import func, select

from safestart.errors import Unavailable
from safestart.processes.execute import execute
from safestart.records.comparable import comparable
from safestart.store.database import Database
from safestart.store.jobs.filters import JobFilter
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.results import ResultRepository
from safestart.store.models import ResultRow
from safestart.store.records import JobStatus
from tests.chaos import claimer
from tests.waiting import PATIENCE_S, until

LEASE_S = 1.0
JOB_S = 0.12
# Here kills are bad luck and no poison.
MAX_ATTEMPTS = 50
# How wrong the claimers' own clocks are, s: a day slow, right, a day fast. The database's clock rules.
CLOCKS = (-86_400.0, 0.0, 86_400.0)


def inputs(number: int) -> dict[str, Any]:
    """Small jobs that differ."""
    return {
        "omega_t_deg_s": 1 + 0.1 * number,
        "a_max_m_s2": 0.1,
        "grid": {"nx": 5, "ny": 5, "y_max_m": 150},
    }


class Herd:
    """A store, claimers on it, and the jobs they are to do."""

    def __init__(self, url: str, folder: Path, lease_s: float = LEASE_S, job_s: float = JOB_S) -> None:
        self.url, self.lease_s, self.job_s = url, lease_s, job_s
        self.said = folder / "late.txt"
        self.said.touch()
        self.database = Database(url)
        self.database.migrate()
        self.jobs = JobRepository(self.database)
        self.processes: list[ForkProcess] = []
        self.ids: list[str] = []
        self._random = random.Random(7)

    def start(self, number: int) -> None:
        """Start claimers, each with another wrong clock."""
        # Forked, so that a start costs no import; a connection must not be shared with the child.
        self.database.close()
        context = multiprocessing.get_context("fork")
        for _ in range(number):
            clock_s = CLOCKS[len(self.processes) % len(CLOCKS)]
            arguments = (self.url, self.lease_s, self.job_s, MAX_ATTEMPTS, clock_s, self.said)
            process = context.Process(target=claimer.work, args=arguments, daemon=True)
            process.start()
            self.processes.append(process)

    def submit(self, number: int) -> None:
        """Queue jobs; a repeated submission with the same key is the same job."""
        for i in range(len(self.ids), len(self.ids) + number):
            submit = lambda i=i: self.jobs.submit(  # noqa: E731
                "certificate", inputs(i), timeout_s=PATIENCE_S, idempotency_key=f"k{i}"
            )
            self.ids.append(self.insist(submit).id)

    def insist(self, call: Callable[[], Any]) -> Any:
        """Call until the database answers, as a client does."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            try:
                return call()
            except Unavailable:
                assert time.monotonic() < deadline, "the database did not come back"
                time.sleep(0.05)

    def busy(self) -> ForkProcess | None:
        """A claimer that holds a job now, or any that lives."""
        running = self.insist(lambda: self.jobs.list(JobFilter([JobStatus.RUNNING]), limit=200)).jobs
        owners = {job.owner for job in running}
        living = [process for process in self.processes if process.is_alive()]
        holding = [process for process in living if f"claimer-{process.pid}" in owners]
        return self._random.choice(holding or living) if living else None

    def kill_one(self) -> None:
        """SIGKILL a claimer, a busy one if there is one, and start another."""
        victim = self.busy()
        if victim is not None and victim.pid is not None:
            os.kill(victim.pid, signal.SIGKILL)
            victim.join()
        self.start(1)

    def open(self) -> int:
        """Jobs that have not ended."""
        counts = self.insist(self.jobs.counts)
        return int(counts["accepted"] + counts["running"])

    def finish(self) -> None:
        """Wait until every job has ended."""
        until(lambda: not self.open(), "the end of every job")

    def check(self) -> None:
        """Nothing lost, nothing doubled, nothing stuck, every result the right one."""
        assert self.jobs.counts() == {
            "accepted": 0,
            "running": 0,
            "successful": len(self.ids),
            "failed": 0,
            "dismissed": 0,
        }
        with self.database.session() as session:
            assert session.scalar(select(func.count()).select_from(ResultRow)) == len(self.ids)
        results = ResultRepository(self.database)
        for number, job_id in enumerate(self.ids):
            told = [e.data["status"] for e in self.jobs.events(job_id) if e.kind == "status"]
            assert told.count("successful") == 1, told
            assert told[-1] == "successful"
            expected = execute("certificate", inputs(number)).document["outputs"]
            assert comparable(results.result(job_id).document["outputs"]) == comparable(expected)
            job = self.jobs.get(job_id)
            assert job.attempts == told.count("running")
            assert job.lease_expires_at is None

    def close(self) -> None:
        """End every claimer, stopped ones too."""
        for process in self.processes:
            if process.is_alive():
                process.kill()
            process.join()
        self.database.close()
