"""A real worker in a separate process, with its own database file."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import psutil

from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.results import ResultRepository
from safestart.store.records import Job, JobStatus
from tests.contract.store.store_backends import pass_time
from tests.waiting import PATIENCE_S, until

# Longer than a worker on a loaded machine may go without renewing; where a lease has to end, Farm.lapse ends it.
LEASE_S = 30.0
MAX_ATTEMPTS = 2
DASK_GIVES_UP_S = 2.0


class Farm:
    """A database and at most one worker on it."""

    def __init__(self, folder: Path, processes: int = 2, warm_up: str = "needed") -> None:
        self._number, self._warm_up = processes, warm_up
        self.url = f"sqlite:///{folder / 'farm.sqlite3'}"
        self.log = folder / "worker.log"
        self.database = Database(self.url)
        self.database.migrate()
        self.jobs = JobRepository(self.database)
        self.results = ResultRepository(self.database)
        self.worker: subprocess.Popen[bytes] | None = None

    def start(self, silence_s: float = PATIENCE_S) -> None:
        """Start the worker unless it runs; returns when it takes jobs."""
        if self.worker is not None and self.worker.poll() is None:
            return
        environment = os.environ | {
            "SAFESTART_LEASE_S": f"{LEASE_S:g}",
            "SAFESTART_MAX_ATTEMPTS": str(MAX_ATTEMPTS),
            "SAFESTART_SILENCE_S": f"{silence_s:g}",
            "SAFESTART_WARM_UP": self._warm_up,
            # Dask's own patience with a process that is to come back, which the worker must not keep to.
            "DASK_DISTRIBUTED__DEPLOY__LOST_WORKER_TIMEOUT": f"{DASK_GIVES_UP_S:g}s",
        }
        command = [sys.executable, "-m", "safestart_worker", "--database-url", self.url]
        already = self.said().count("takes jobs from")
        with self.log.open("ab") as log:
            self.worker = subprocess.Popen(
                [*command, "--processes", str(self._number)], stdout=log, stderr=log, env=environment
            )
        until(lambda: self.said().count("takes jobs from") > already, "a worker that takes jobs")

    def said(self) -> str:
        """Everything the workers have logged."""
        return self.log.read_text(errors="replace") if self.log.exists() else ""

    def submit(self, process_id: str, inputs: dict[str, Any], timeout_s: float = 300.0) -> str:
        """Submit a job and return its id."""
        return self.jobs.submit(process_id, inputs, timeout_s=timeout_s).id

    def ended(self, job_id: str, within_s: float = PATIENCE_S) -> Job:
        """Wait for the end of a job."""
        until(lambda: self.jobs.get(job_id).status.ended, f"the end of {self.jobs.get(job_id)}", within_s)
        return self.jobs.get(job_id)

    def computing(self, job_id: str, percent: float = 0.0) -> psutil.Process:
        """Wait until a job has reported more than ``percent``; returns the task process it runs in."""

        def there() -> bool:
            job = self.jobs.get(job_id)
            assert not job.status.ended, job
            reported = any(event.kind == "progress" for event in self.jobs.events(job_id))
            return job.status is JobStatus.RUNNING and reported and (job.progress > percent or percent == 0.0)

        until(there, f"progress of {self.jobs.get(job_id)}")
        found = re.findall(rf"job={job_id} runs in process (\d+)", self.said())
        return psutil.Process(int(found[-1]))

    def lapse(self) -> None:
        """The time of a lease passes."""
        pass_time(self.database, LEASE_S + 1.0)

    def stop(self) -> None:
        """Stop the worker if it runs."""
        if self.worker is not None and self.worker.poll() is None:
            self.worker.terminate()
            self.worker.wait(PATIENCE_S)

    def processes(self) -> list[psutil.Process]:
        """Every process the worker has started."""
        assert self.worker is not None
        return psutil.Process(self.worker.pid).children(recursive=True)

    def task_processes(self) -> list[psutil.Process]:
        """Those that compute."""
        found = []
        for process in self.processes():
            with suppress(psutil.NoSuchProcess):
                if any("spawn_main" in word for word in process.cmdline()):
                    found.append(process)
        return found

    def close(self) -> None:
        """Stop the worker and leave the database."""
        self.stop()
        self.database.close()


def over(processes: list[psutil.Process]) -> bool:
    """True when none of them runs any more."""
    return not any(p.is_running() and p.status() != psutil.STATUS_ZOMBIE for p in processes)
