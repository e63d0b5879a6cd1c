"""A database written by an earlier release migrates and reads."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import MetaData, create_engine, insert, select, text

from safestart.store import schema
from safestart.store.cache import Cache
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.results import ResultRepository
from safestart.store.records import JobStatus

DUMPS = sorted(Path(__file__).parent.glob("database_*.sql"))


def written_by_an_earlier_release(dump: Path, url: str, folder: Path) -> None:
    """The stored database; on PostgreSQL its rows in the tables that its release made there."""
    path = folder / ("store.sqlite3" if url.startswith("sqlite") else "dump.sqlite3")
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(dump.read_text())
    if url.startswith("sqlite"):
        return
    old, new = create_engine(f"sqlite:///{path}"), create_engine(url)
    with old.connect() as source, new.begin() as target:
        revision = schema.version(source)
        assert revision is not None
        schema.upgrade(target, revision)
        there, here = MetaData(), MetaData()
        there.reflect(source)
        here.reflect(target)
        for table in here.sorted_tables:
            rows = [dict(row) for row in source.execute(select(there.tables[table.name])).mappings()]
            if table.name != "alembic_version" and rows:
                target.execute(insert(table), rows)
        target.execute(text("SELECT setval('jobs_seq_seq', 100), setval('events_id_seq', 100)"))
    new.dispose()
    old.dispose()


@pytest.mark.parametrize("dump", DUMPS, ids=lambda path: path.stem)
def test_every_stored_schema_migrates_and_reads(dump: Path, url: str, tmp_path: Path) -> None:
    written_by_an_earlier_release(dump, url, tmp_path)
    database = Database(url)
    database.migrate()
    jobs, results = JobRepository(database), ResultRepository(database)
    counts = jobs.counts()
    assert counts[JobStatus.SUCCESSFUL] == 1
    assert counts[JobStatus.ACCEPTED] == 1
    claim = jobs.claim("worker", 30.0)
    assert claim is not None
    assert jobs.submit("certificate", {}, timeout_s=60.0).id != claim.job_id
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
