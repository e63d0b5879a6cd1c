"""A database written by an earlier release migrates and reads."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from safestart.store.cache import Cache
from safestart.store.database import Database
from safestart.store.jobs import JobRepository
from safestart.store.records import JobStatus
from safestart.store.results import ResultRepository

DUMPS = sorted(Path(__file__).parent.glob("database_*.sql"))


@pytest.mark.parametrize("dump", DUMPS, ids=lambda path: path.stem)
def test_every_stored_schema_migrates_and_reads(dump: Path, tmp_path: Path) -> None:
    path = tmp_path / "old.sqlite3"
    with sqlite3.connect(path) as connection:
        connection.executescript(dump.read_text())
    connection.close()
    database = Database(f"sqlite:///{path}")
    database.migrate()
    jobs, results = JobRepository(database), ResultRepository(database)
    counts = jobs.counts()
    assert counts[JobStatus.SUCCESSFUL] == 1
    assert counts[JobStatus.ACCEPTED] == 1
    claim = jobs.claim("worker", 30.0)
    assert claim is not None
    jobs.succeed(claim, {"outputs": {}}, (), {})
    done = [job for job in jobs.list().jobs if job.status is JobStatus.SUCCESSFUL]
    assert len(done) == 2
    old = next(job for job in done if job.id != claim.job_id)
    assert results.result(old.id).document["outputs"]["rows"][0]["area_m2"] == 12.5
    assert results.artifact(old.id, "map.png").data.startswith(b"\x89PNG")
    cache = Cache(database)
    cache.keep("k", b"v")
    assert cache.find("k") == b"v"
    database.close()
