"""A worker on a Dask cluster that was there before it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.records import JobStatus
from tests.acceptance.certificates import Authority
from tests.acceptance.test_worker import CERTIFICATE, STEADY
from tests.waiting import PATIENCE_S, accepts, free_port, until


@pytest.fixture
def processes() -> Iterator[list[subprocess.Popen[bytes]]]:
    started: list[subprocess.Popen[bytes]] = []
    yield started
    for process in reversed(started):
        process.terminate()
        try:
            process.wait(60)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def test_jobs_run_on_it_and_wait_again_when_it_goes_away(
    tmp_path: Path, processes: list[subprocess.Popen[bytes]]
) -> None:
    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    url = f"sqlite:///{tmp_path / 'jobs.sqlite3'}"
    database = Database(url)
    database.migrate()
    jobs = JobRepository(database)
    with (tmp_path / "log").open("wb") as log:

        def start(*command: str) -> subprocess.Popen[bytes]:
            processes.append(subprocess.Popen([sys.executable, "-m", *command], stdout=log, stderr=log))
            return processes[-1]

        scheduler = start(
            "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"
        )
        until(lambda: accepts(port), "a scheduler that listens", log=tmp_path / "log")
        start("distributed.cli.dask_worker", address, "--nthreads", "1", "--nworkers", "1", "--no-dashboard")
        first = jobs.submit("certificate", CERTIFICATE, timeout_s=PATIENCE_S).id
        worker = start("safestart_worker", "--database-url", url, "--scheduler", address)
        until(lambda: jobs.get(first).status.ended, "the end of the first job")
        assert jobs.get(first).status is JobStatus.SUCCESSFUL

        second = jobs.submit("coverage", STEADY, timeout_s=PATIENCE_S).id
        third = jobs.submit("coverage", STEADY, timeout_s=PATIENCE_S).id
        until(lambda: jobs.get(second).progress > 0, "progress")
        assert jobs.position(third) == 1, "no more jobs are taken than the cluster has threads"
        scheduler.kill()
        assert worker.wait(PATIENCE_S) == 1
    assert b"the connection to the scheduler is lost" in (tmp_path / "log").read_bytes()
    assert jobs.get(second).status is JobStatus.ACCEPTED
    assert jobs.get(second).attempts == 0
    database.close()


def test_jobs_run_on_one_with_tls(tmp_path: Path, processes: list[subprocess.Popen[bytes]]) -> None:
    """By nothing but Dask's own configuration, here its variables."""
    port = free_port()
    address = f"tls://127.0.0.1:{port}"
    url = f"sqlite:///{tmp_path / 'jobs.sqlite3'}"
    database = Database(url)
    database.migrate()
    jobs = JobRepository(database)
    environment = os.environ | Authority(tmp_path / "certificates").environment()
    where = ("--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
    with (tmp_path / "log").open("wb") as log:
        for command in (
            ("distributed.cli.dask_scheduler", "--protocol", "tls", *where),
            ("distributed.cli.dask_worker", address, "--nthreads", "1", "--nworkers", "1", "--no-dashboard"),
            ("safestart_worker", "--database-url", url, "--scheduler", address),
        ):
            arguments = [sys.executable, "-m", *command]
            processes.append(subprocess.Popen(arguments, stdout=log, stderr=log, env=environment))
            until(lambda: accepts(port), "a scheduler that listens", log=tmp_path / "log")
        job = jobs.submit("certificate", CERTIFICATE, timeout_s=PATIENCE_S).id
        until(lambda: jobs.get(job).status.ended, "the end of the job", log=tmp_path / "log")
    assert jobs.get(job).status is JobStatus.SUCCESSFUL
    assert "at tls://127.0.0.1:" in (tmp_path / "log").read_text()
    database.close()


def test_a_scheduler_that_is_not_there_is_named(tmp_path: Path) -> None:
    address = f"tcp://127.0.0.1:{free_port()}"
    url = f"sqlite:///{tmp_path / 'jobs.sqlite3'}"
    for wrong in (address, "no address at all", "tls://127.0.0.1:8786"):
        ended = subprocess.run(
            [sys.executable, "-m", "safestart_worker", "--database-url", url, "--scheduler", wrong],
            capture_output=True,
            text=True,
            timeout=PATIENCE_S,
            env=os.environ,
        )
        assert ended.returncode == 2, ended.stderr
        assert "scheduler: required" in ended.stderr
        assert wrong in ended.stderr
