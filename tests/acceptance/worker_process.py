"""A real worker in a process of its own, on a database file of its own."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import psutil

from safestart.store.database import Database
from safestart.store.jobs import JobRepository
from safestart.store.records import Job, JobStatus
from safestart.store.results import ResultRepository

PROCESSES = 2
LEASE_S = 3.0
MAX_ATTEMPTS = 2
SILENCE_S = 8.0
READY_S = 120.0


def until(condition: Callable[[], Any], within_s: float, what: str) -> Any:
    """Wait for a true answer and return it."""
    deadline = time.monotonic() + within_s
    while not (answer := condition()):
        assert time.monotonic() < deadline, f"waited {within_s:g} s for {what}"
        time.sleep(0.02)
    return answer


class Farm:
    """A database and at most one worker on it."""

    def __init__(self, folder: Path) -> None:
        self.url = f"sqlite:///{folder / 'farm.sqlite3'}"
        self.log = folder / "worker.log"
        self.database = Database(self.url)
        self.database.migrate()
        self.jobs = JobRepository(self.database)
        self.results = ResultRepository(self.database)
        self.worker: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start the worker unless it runs; returns when it takes jobs."""
        if self.worker is not None and self.worker.poll() is None:
            return
        environment = os.environ | {
            "SAFESTART_LEASE_S": f"{LEASE_S:g}",
            "SAFESTART_MAX_ATTEMPTS": str(MAX_ATTEMPTS),
            "SAFESTART_SILENCE_S": f"{SILENCE_S:g}",
        }
        command = [sys.executable, "-m", "safestart_worker", "--database-url", self.url]
        already = self.said().count("takes jobs from")
        with self.log.open("ab") as log:
            self.worker = subprocess.Popen(
                [*command, "--processes", str(PROCESSES)], stdout=log, stderr=log, env=environment
            )
        until(lambda: self.said().count("takes jobs from") > already, READY_S, "a worker that takes jobs")

    def said(self) -> str:
        """Everything the workers have logged."""
        return self.log.read_text(errors="replace") if self.log.exists() else ""

    def submit(self, process_id: str, inputs: dict[str, Any], timeout_s: float = 300.0) -> str:
        """Submit a job and return its id."""
        return self.jobs.submit(process_id, inputs, timeout_s=timeout_s).id

    def ended(self, job_id: str, within_s: float = 120.0) -> Job:
        """Wait for the end of a job."""
        until(lambda: self.jobs.get(job_id).status.ended, within_s, f"the end of {self.jobs.get(job_id)}")
        return self.jobs.get(job_id)

    def computing(self, job_id: str, percent: float = 0.0, within_s: float = 60.0) -> psutil.Process:
        """Wait until a job has reported more than ``percent``; returns the task process it runs in."""

        def there() -> bool:
            job = self.jobs.get(job_id)
            assert not job.status.ended, job
            reported = any(event.kind == "progress" for event in self.jobs.events(job_id))
            return job.status is JobStatus.RUNNING and reported and (job.progress > percent or percent == 0.0)

        until(there, within_s, f"progress of {self.jobs.get(job_id)}")
        found = re.findall(rf"job={job_id} runs in process (\d+)", self.said())
        return psutil.Process(int(found[-1]))

    def processes(self) -> list[psutil.Process]:
        """Every process the worker has started."""
        assert self.worker is not None
        return psutil.Process(self.worker.pid).children(recursive=True)

    def close(self) -> None:
        """Stop the worker."""
        if self.worker is not None and self.worker.poll() is None:
            self.worker.terminate()
            self.worker.wait(30)
        self.database.close()


def over(processes: list[psutil.Process]) -> bool:
    """True when none of them runs any more."""
    return not any(p.is_running() and p.status() != psutil.STATUS_ZOMBIE for p in processes)
