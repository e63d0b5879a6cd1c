"""Backup and restore: one SQLite file that holds every table, whichever database it was made from.

A backup can be restored into either kind of database, so this is also the way from SQLite to PostgreSQL.
"""

from __future__ import annotations

import os
import sqlite3
import tempfile
from contextlib import closing
from pathlib import Path

from sqlalchemy import Connection, Table, func, insert, select, text

from safestart.errors import Conflict, InvalidInput, Unavailable
from safestart.store.database import Database
from safestart.store.models import Base

_BATCH = 100
# Only true at the moment, so left out of a backup.
_LEFT_OUT = frozenset({"workers"})
# A restore replaces these tables, which hold nobody's record: migrations fill the counters, and a running service
# fills the cache.
_REPLACED = frozenset({"tally", "cache"})


def backup(database: Database, target: Path) -> int:
    """Write a consistent copy to ``target`` while everything runs; returns the number of jobs in it.

    Raises ``InvalidInput`` when the file exists already or cannot be written.
    """
    try:
        return _backup(database, target)
    except OSError as error:
        raise _refused(target, "a path that can be written", str(error.strerror)) from None


def _backup(database: Database, target: Path) -> int:
    if target.exists():
        raise _refused(target, "a file that does not exist yet", "one that exists")
    if not target.parent.is_dir():
        raise _refused(target, "a path in an existing directory", "another")
    draft = target.with_name(target.name + ".part")
    draft.unlink(missing_ok=True)
    try:
        if database.file is not None:
            _copy_file(database.file, draft)
        else:
            _copy_rows_to(database, draft)
        jobs = _check(draft)
        os.replace(draft, target)
    finally:
        for leftover in (draft, Path(f"{draft}-wal"), Path(f"{draft}-shm")):
            leftover.unlink(missing_ok=True)
    return jobs


def restore(database: Database, source: Path) -> int:
    """Fill an empty database from a backup of this version or an older one; returns the number of jobs.

    Raises ``Conflict`` when the database holds jobs, keys or an audit log, and ``InvalidInput`` for a file that is
    not a backup.
    """
    if not source.is_file():
        raise _refused(source, "a backup", "no file")
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "backup.sqlite3"
        _copy_file(source, copy)
        _check(copy)
        old = Database(f"sqlite:///{copy}")
        try:
            old.migrate()
            database.migrate()
            with old.session() as source_session, database.session(write=True) as session:
                connection = session.connection()
                _require_empty(connection)
                _copy_rows(source_session.connection(), connection)
                jobs = connection.scalar(select(func.count()).select_from(Base.metadata.tables["jobs"]))
                return int(jobs or 0)
        finally:
            old.close()


def _copy_file(source: Path, target: Path) -> None:
    try:
        with closing(sqlite3.connect(source)) as one, closing(sqlite3.connect(target)) as two:
            one.backup(two)
            two.execute("PRAGMA journal_mode = DELETE")  # one file, without a journal file beside it
    except sqlite3.Error as error:
        raise Unavailable(f"backup: {source} could not be copied to {target}: {error}") from None


def _copy_rows_to(database: Database, target: Path) -> None:
    copy = Database(f"sqlite:///{target}")
    try:
        copy.migrate()
        with database.snapshot() as connection, copy.session(write=True) as session:
            _copy_rows(connection, session.connection())
    finally:
        copy.close()


def _copy_rows(source: Connection, target: Connection) -> None:
    """Copy every row of every table, parents first, a batch at a time."""
    for table in Base.metadata.sorted_tables:
        if table.name in _LEFT_OUT:
            continue
        if table.name in _REPLACED:
            target.execute(table.delete())
        batches = source.execution_options(yield_per=_BATCH).execute(select(table)).mappings().partitions()
        for rows in batches:
            target.execute(insert(table), [dict(row) for row in rows])
        _continue_numbers(target, table)


def _continue_numbers(target: Connection, table: Table) -> None:
    """PostgreSQL: make the next number of each counting column follow the copied ones."""
    column = table.autoincrement_column
    if target.dialect.name != "postgresql" or column is None or column.type.python_type is not int:
        return
    name = target.scalar(
        text("SELECT pg_get_serial_sequence(:table, :column)"), {"table": table.name, "column": column.name}
    )
    if name is not None:
        most = target.scalar(select(func.max(column)))
        target.execute(text("SELECT setval(:name, :next, false)"), {"name": name, "next": (most or 0) + 1})


def _check(path: Path) -> int:
    """Check that the file is an intact SQLite database of ours; returns its number of jobs."""
    try:
        with closing(sqlite3.connect(path)) as connection:
            said = connection.execute("PRAGMA integrity_check").fetchone()[0]
            if said != "ok":
                raise _refused(path, "a sound database", str(said))
            connection.execute("SELECT version_num FROM alembic_version")
            return int(connection.execute("SELECT count(*) FROM jobs").fetchone()[0])
    except sqlite3.Error as error:
        raise _refused(path, "a backup of a safestart database", str(error)) from None


def _require_empty(connection: Connection) -> None:
    """Raise ``Conflict`` when the database holds a record: restored rows must not mix with it."""
    for table in Base.metadata.sorted_tables:
        if table.name in _LEFT_OUT | _REPLACED:
            continue
        number = connection.scalar(select(func.count()).select_from(table))
        if number:
            raise Conflict(
                f"the database holds {number} rows of {table.name}; required an empty one",
                required="an empty database",
                received=f"{number} rows of {table.name}",
            )


def _refused(path: Path, required: str, received: str) -> InvalidInput:
    return InvalidInput(f"{path}: required {required}, received {received}", field="file", required=required)
