"""A worker without a cluster: claims, renews, computes in its own process, writes, as the real one does."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any

from safestart.errors import LeaseLost, Unavailable
from safestart.processes.execute import execute
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.records import Claim

AWAY_S = 0.1
PAUSE_S = 0.02


def work(url: str, lease_s: float, job_s: float, max_attempts: int, clock_s: float, said: Path) -> None:
    """Take jobs for ever; each takes ``job_s`` besides its computation. ``clock_s``: how wrong our own clock is."""
    real = time.time
    time.time = lambda: real() + clock_s
    database = Database(url)
    jobs = JobRepository(database)
    owner = f"claimer-{os.getpid()}"
    while True:
        try:
            claim = jobs.claim(owner, lease_s, max_attempts)
        except Unavailable:
            time.sleep(AWAY_S)
            continue
        if claim is None:
            time.sleep(PAUSE_S)
            continue
        try:
            _run(jobs, claim, lease_s, job_s)
        except LeaseLost as lost:
            with said.open("a") as file:
                file.write(f"{claim.job_id} {owner} {lost.detail}\n")


def _run(jobs: JobRepository, claim: Claim, lease_s: float, job_s: float) -> None:
    end = time.monotonic() + job_s
    step = 0
    while time.monotonic() < end:
        step += 1
        # Between those two a claimer that is stopped comes back too late.
        time.sleep(job_s / 4)
        _stubborn(lambda: jobs.renew(claim, lease_s))
        _stubborn(lambda step=step: jobs.progress(claim, 20.0 * step, f"step {step}", None))
    done = execute(claim.process_id, claim.inputs)
    document: dict[str, Any] = done.document
    _stubborn(lambda: jobs.succeed(claim, document, done.artifacts, {"owner": claim.owner}))


def _stubborn(write: Any) -> None:
    while True:
        try:
            write()
        except Unavailable:
            time.sleep(AWAY_S)
        else:
            return
