"""Workers, the database server and the disk fail under thirty jobs; nothing is lost, doubled or stuck."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from safestart.errors import Unavailable
from safestart.store.jobs.filters import JobFilter
from safestart.store.records import JobStatus
from tests.chaos.herd import Herd
from tests.chaos.server import Server
from tests.contract.store.store_backends import BACKENDS, fresh_url
from tests.waiting import PATIENCE_S, until

JOBS, KILLS = 30, 10


@pytest.fixture(params=BACKENDS)
def herd(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Herd]:
    herd = Herd(fresh_url(request.param, tmp_path), tmp_path)
    yield herd
    herd.close()


def test_workers_are_killed(herd: Herd) -> None:
    """Ten times kill -9 of a busy worker; their clocks are days apart. On SQLite they share one file."""
    herd.submit(JOBS)
    herd.start(2)
    kills = 0
    while kills < KILLS:
        time.sleep(0.15)
        herd.kill_one()
        kills += 1
        if herd.open() < 5:  # they were faster than the killer
            herd.submit(JOBS // 3)
    herd.finish()
    herd.check()
    assert herd.jobs.tallies()["lease_losses"] >= 1
    assert sum(herd.jobs.get(job).attempts for job in herd.ids) > len(herd.ids)


def test_zombies_come_back_and_are_refused(herd: Herd) -> None:
    """A busy worker stops for longer than its lease and continues: the store refuses its writes."""
    herd.job_s = 0.6
    herd.submit(JOBS)
    herd.start(3)
    for _ in range(10):
        zombie, job = stop_one(herd)
        # One that was stopped in the middle of a write keeps a lock, and others from taking over: the next one, then.
        taken = happens(
            lambda job=job, zombie=zombie: (
                herd.insist(lambda: herd.jobs.get(job)).owner != f"claimer-{zombie}"
            )
        )
        os.kill(zombie, signal.SIGCONT)
        # One that was stopped in its last write may well have ended its job.
        if taken and happens(lambda: herd.said.read_text()):
            break
        if herd.open() < 5:
            herd.submit(JOBS // 3)
    herd.finish()
    herd.check()
    refused = {line.split()[0] for line in herd.said.read_text().splitlines()}
    assert refused, "a zombie wrote, and was refused"
    assert refused <= set(herd.ids)


def happens(condition: Callable[[], object], within_s: float = 15.0) -> bool:
    """True once it holds; until then it is not a failure."""
    try:
        until(condition, "it", within_s)
    except AssertionError:
        return False
    return True


def stop_one(herd: Herd) -> tuple[int, str]:
    """SIGSTOP a worker that holds a job: its process and the job."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        for job in herd.jobs.list(JobFilter([JobStatus.RUNNING])).jobs:
            zombie = int(str(job.owner).removeprefix("claimer-"))
            os.kill(zombie, signal.SIGSTOP)
            if herd.jobs.get(job.id).owner == job.owner:
                return zombie, job.id
            os.kill(zombie, signal.SIGCONT)
        time.sleep(0.02)
    raise AssertionError("no worker was busy")


def test_the_database_server_is_killed(tmp_path: Path) -> None:
    """kill -9 of every process of a PostgreSQL server, three times; everything answered is still there."""
    # Its own folder: pytest's is closed to other users.
    with tempfile.TemporaryDirectory(prefix="safestart-chaos-") as folder:
        home = Path(folder) / "server"
        home.mkdir()
        Path(folder).chmod(0o755)
        server = Server(home)
        server.start()
        herd = Herd(server.url, tmp_path)
        try:
            herd.submit(JOBS // 2)
            herd.start(2)
            for _ in range(3):
                time.sleep(0.3)
                server.kill()
                with pytest.raises(Unavailable):
                    herd.jobs.counts()
                time.sleep(0.2)
                server.start()
            herd.submit(JOBS - JOBS // 2)
            herd.finish()
            herd.check()
        finally:
            herd.close()
            server.kill()


def test_the_disk_is_full(tmp_path: Path) -> None:
    """A submission that does not fit is refused and leaves nothing; with room again everything goes on."""
    with small_disk(tmp_path) as disk:
        herd = Herd(f"sqlite:///{disk / 'store.sqlite3'}", tmp_path)
        try:
            herd.submit(5)
            ballast = disk / "ballast"
            fill(ballast)
            with pytest.raises(Unavailable, match=r"full|I/O error"):
                submit_much(herd)
            accepted = herd.jobs.counts()["accepted"]
            herd.start(2)  # they cannot even claim
            time.sleep(0.5)
            assert sum(herd.jobs.counts().values()) == accepted
            ballast.unlink()
            for job in herd.jobs.list(limit=1000).jobs:
                if "text" in herd.jobs.get(job.id).inputs:  # the jobs that happened to fit, claimed or not
                    herd.ids = [known for known in herd.ids if known != job.id]
                    herd.insist(lambda job=job: herd.jobs.dismiss(job.id))
            until(lambda: all(herd.jobs.get(job).status.ended for job in herd.ids), "the end of every job")
            assert all(herd.jobs.get(job).status is JobStatus.SUCCESSFUL for job in herd.ids)
            assert len(herd.ids) == 5
        finally:
            herd.close()


def fill(file: Path) -> None:
    """Write until nothing fits any more."""
    with pytest.raises(OSError, match="No space left"), file.open("wb", buffering=0) as target:  # noqa: PT012
        while True:
            target.write(bytes(65536))


def submit_much(herd: Herd) -> None:
    for _ in range(200):
        herd.jobs.submit("certificate", {"text": "x" * 20_000}, timeout_s=PATIENCE_S)


class small_disk:
    """A file system of 2 MiB of its own; skips where it cannot be mounted."""

    def __init__(self, folder: Path) -> None:
        self._mount = folder / "disk"

    def __enter__(self) -> Path:
        self._mount.mkdir()
        mount = shutil.which("mount")
        command = [mount or "mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", str(self._mount)]
        if mount is None or subprocess.run(command, capture_output=True).returncode != 0:
            pytest.skip("no small file system could be mounted (that takes root on Linux)")
        return self._mount

    def __exit__(self, *_: object) -> None:
        subprocess.run(["umount", str(self._mount)], check=True)
