"""The store, on every backend: the database itself."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import make_url, text

from safestart.errors import (
    Away,
    InvalidInput,
    Unavailable,
)
from safestart.store import dialect, schema
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.models import Base
from tests.contract.store.store_backends import NO_SERVER, POSTGRESQL, ask
from tests.contract.store.store_jobs import submit
from tests.waiting import PATIENCE_S


def test_the_migrations_make_the_tables_of_the_models(database: Database) -> None:
    database.migrate()
    with database.session() as session:
        context = MigrationContext.configure(session.connection())
        assert compare_metadata(context, Base.metadata) == []
        assert schema.version(session.connection()) == schema.HEAD


def test_processes_that_migrate_at_once_all_succeed(url: str) -> None:
    code = "import sys; from safestart.store.database import Database; Database(sys.argv[1]).migrate()"
    started = [
        subprocess.Popen([sys.executable, "-c", code, url], stderr=subprocess.PIPE, text=True)
        for _ in range(4)
    ]
    for process in started:
        _, said = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0, said


def test_a_newer_schema_is_refused(database: Database) -> None:

    with database.session(write=True) as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(Unavailable, match="a schema this version does not know"):
        database.migrate()


def test_a_query_is_answered(database: Database) -> None:
    ask(database)


@pytest.mark.parametrize(
    ("wrong", "kind", "said"),
    [
        ("mysql://user:hunter2@host/name", InvalidInput, "required sqlite:///PATH"),
        ("rubbish hunter2", InvalidInput, "required sqlite:///PATH"),
        ("", InvalidInput, "required sqlite:///PATH"),
        ("sqlite://", InvalidInput, "in memory"),
        ("sqlite:////nonexistent/folder/file.sqlite3", Unavailable, "existing, writable directory"),
        ("sqlite:////", Unavailable, "existing, writable directory"),
        ("postgresql://user:hunter2@127.0.0.1:9/name", Unavailable, "postgresql"),
        ("postgresql://user@127.0.0.1:9/name?password=hunter2", Unavailable, "password=***"),
        ("postgresql://user:of@hunter2@host/name", InvalidInput, "two @"),
        ("postgresql://user:hunter2@host:99999/name", InvalidInput, "port 99999"),
        ("postgresql+psycopg2://user:hunter2@host/name", InvalidInput, "received postgresql+psycopg2"),
        ("postgresql+psycopg_async://user:hunter2@host/name", InvalidInput, "required sqlite:///PATH"),
    ],
)
def test_a_database_that_cannot_be_says_what_is_required(
    wrong: str, kind: type[Exception], said: str
) -> None:
    with pytest.raises(kind) as caught:
        Database(wrong).migrate()
    assert said in str(caught.value)
    assert "hunter2" not in str(caught.value)


@pytest.mark.skipif(not POSTGRESQL, reason=NO_SERVER)
@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"database": "nonexistent"}, "does not exist"),
        ({"username": "nobody_here"}, "nobody_here"),
        ({"query": {"sslmode": "rubbish"}}, "invalid sslmode"),
        ({"query": {"rubbish": "1"}}, "invalid connection option"),
    ],
)
def test_a_server_that_refuses_us_is_not_waited_for(change: dict, said: str) -> None:
    url = make_url(POSTGRESQL).set(**change).render_as_string(hide_password=False)
    with pytest.raises(Unavailable, match=said) as caught:
        Database(url).migrate()
    assert not isinstance(caught.value, Away)


def test_a_server_that_does_not_answer_is_waited_for() -> None:
    with pytest.raises(Away):
        ask(Database("postgresql://user@127.0.0.1:9/name"))


def test_a_file_that_is_no_database_is_unavailable(tmp_path: Path) -> None:
    (tmp_path / "x").write_text("not a database, but long enough to have a header to look at " * 20)
    with pytest.raises(Unavailable, match="file is not a database"):
        ask(Database(f"sqlite:///{tmp_path / 'x'}"))


def test_another_error_rolls_back_and_passes_through(database: Database, jobs: JobRepository) -> None:

    job = submit(jobs)

    def half_a_change() -> None:
        with database.session(write=True) as session:
            session.execute(text("UPDATE jobs SET message = 'half'"))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        half_a_change()
    assert jobs.get(job.id).message == ""


def test_what_somebody_else_has_locked_is_not_waited_for_without_end(
    url: str, database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dialect, "BUSY_TIMEOUT_S", 0.1)
    hasty = Database(url)
    with database.session(write=True) as session:
        session.connection()  # SQLite's lock
        if not database.one_writer:
            session.execute(text("LOCK TABLE jobs"))
        with pytest.raises(Unavailable, match="lock"):
            submit(JobRepository(hasty))
    submit(JobRepository(hasty))
    hasty.close()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
def test_a_forked_process_has_connections_of_its_own(jobs: JobRepository, database: Database) -> None:
    """Otherwise both speak on one, and what SQLite knows of its own locks is not true in the child."""
    first = submit(jobs)
    with database.session(write=True) as under_way:
        under_way.connection()
        child = os.fork()
        if child == 0:
            found = 1
            with suppress(BaseException):
                found = 0 if jobs.get(first.id) == first else 2
                gc.collect()
            os._exit(found)
        assert os.waitpid(child, 0)[1] == 0
        under_way.connection().exec_driver_sql("SELECT 1")
    assert submit(jobs).id != first.id


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere no folder shows the open files")
def test_a_forked_process_inherits_no_idle_connection(jobs: JobRepository, database: Database) -> None:
    submit(jobs)
    child = os.fork()
    if child == 0:
        found = 1
        with suppress(BaseException):
            held = [os.readlink(one) for one in Path("/proc/self/fd").iterdir() if one.is_symlink()]
            found = int(database.file is not None and any(str(database.file) in one for one in held))
        os._exit(found)
    assert os.waitpid(child, 0)[1] == 0
