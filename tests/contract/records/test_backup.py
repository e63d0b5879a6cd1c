"""Backups and retention, on every backend."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import inspect

from safestart.errors import Conflict, InvalidInput, SafestartError
from safestart.records.bundle import pack
from safestart.runtime.access import Role
from safestart.store.access.keys import KeyRepository
from safestart.store.backup import backup, restore
from safestart.store.cache import Cache
from safestart.store.database import Database
from safestart.store.jobs import retention
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.results import ResultRepository
from safestart.store.jobs.retention import Retention
from safestart.store.models import Base
from safestart.store.transfer import Transfer
from tests.contract.access.key_holders import BY
from tests.contract.api.service_client import SMALL
from tests.contract.records.finished import done
from tests.contract.store.store_backends import BACKENDS, fresh_url


def test_a_backup_restores_into_every_kind_of_database(
    database: Database, execution: Any, tmp_path: Path
) -> None:
    job = done(database, execution)
    waiting = JobRepository(database).submit("benchmark", SMALL, timeout_s=60.0).id
    file = tmp_path / "copy.sqlite3"
    assert backup(database, file) == 2
    assert [path.name for path in tmp_path.glob("copy*")] == ["copy.sqlite3"]
    with pytest.raises(InvalidInput, match="required a file that does not exist yet"):
        backup(database, file)
    with pytest.raises(Conflict, match="required an empty one"):
        restore(database, file)
    for backend in ("sqlite", "postgresql"):
        if backend == "postgresql" and database.file is not None and BACKENDS[1].marks[0].args[0]:
            continue  # no server
        folder = tmp_path / backend
        folder.mkdir()
        other = Database(fresh_url(backend, folder))
        assert restore(other, file) == 2
        jobs, results = JobRepository(other), ResultRepository(other)
        assert jobs.get(job) == JobRepository(database).get(job)
        assert jobs.events(job) == JobRepository(database).events(job)
        assert results.result(job) == ResultRepository(database).result(job)
        assert pack(Transfer(other).read(job)) == pack(Transfer(database).read(job))
        claim = jobs.claim("worker", 30.0)
        assert claim is not None
        assert claim.job_id == waiting
        assert jobs.submit("benchmark", SMALL, timeout_s=60.0).id not in (job, waiting)
        assert jobs.tallies() == JobRepository(database).tallies()
        other.close()


def test_a_backup_copies_every_table_that_there_is(database: Database) -> None:
    with database.session() as session:
        there = set(inspect(session.connection()).get_table_names()) - {"alembic_version"}
    assert there == set(Base.metadata.tables)


def test_a_backup_replaces_the_cache_and_mixes_with_nobodys_record(
    url: str, execution: Any, tmp_path: Path
) -> None:
    source = Database(f"sqlite:///{tmp_path / 'source.sqlite3'}")
    source.migrate()
    done(source, execution)
    Cache(source).keep("k", b"old")
    file = tmp_path / "copy.sqlite3"
    backup(source, file)
    source.close()
    target = Database(url)
    target.migrate()
    Cache(target).keep("other", b"of a service that runs already")
    assert restore(target, file) == 1
    assert (Cache(target).find("k"), Cache(target).find("other")) == (b"old", None)
    target.close()
    keyed = Database(f"sqlite:///{tmp_path / 'keyed.sqlite3'}")
    keyed.migrate()
    KeyRepository(keyed).create("me", Role.ADMIN, None, BY)
    with pytest.raises(Conflict, match=r"1 rows of (api_keys|audit); required an empty one"):
        restore(keyed, file)
    assert JobRepository(keyed).list().jobs == ()
    keyed.close()


def test_a_backup_to_where_nothing_can_be_written_is_refused(database: Database, tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="required a path that can be written"):
        backup(database, tmp_path / ("x" * 300))


def test_what_is_no_backup_is_refused(database: Database, tmp_path: Path) -> None:
    (tmp_path / "x").write_text("no database " * 100)
    with closing(sqlite3.connect(tmp_path / "foreign")) as connection:
        connection.execute("CREATE TABLE jobs (x)")
    for wrong in (tmp_path / "x", tmp_path / "nothing", tmp_path / "foreign"):
        with pytest.raises(SafestartError, match=r"required a backup|could not be copied"):
            restore(database, wrong)


def test_only_what_ended_long_ago_is_purged(database: Database, execution: Any) -> None:
    jobs, kept = JobRepository(database), Retention(database)
    old = done(database, execution)
    running = jobs.submit("benchmark", SMALL, timeout_s=60.0).id
    assert jobs.claim("worker", 30.0) is not None
    waiting = jobs.submit("benchmark", SMALL, timeout_s=60.0).id
    assert kept.older(3600.0) == kept.purge(3600.0) == 0
    assert kept.older(-1.0) == kept.purge(-1.0) == 1
    assert {job.id for job in jobs.list().jobs} == {running, waiting}
    assert jobs.events(old) == ()
    assert kept.purge(-1.0) == 0


def test_others_write_while_much_is_purged(
    url: str, database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    jobs, other = JobRepository(database), JobRepository(Database(url))
    old = [jobs.dismiss(jobs.submit("benchmark", SMALL, timeout_s=60.0).id).id for _ in range(25)]
    new: list[str] = []
    monkeypatch.setattr(
        retention, "sleep", lambda _: new.append(other.submit("benchmark", SMALL, timeout_s=60.0).id)
    )
    assert Retention(database).purge(-1.0) == len(old)
    assert {job.id for job in jobs.list().jobs} == set(new) != set()
