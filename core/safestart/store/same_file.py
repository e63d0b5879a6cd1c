"""Every transaction is in the SQLite file at its path; SQLite itself goes on in a file that was moved or deleted.

A job accepted there would be lost. Only a migration makes a missing file, and only before this process has seen one:
the next connection would otherwise open an empty database in its place. A copy of the same database may take the
place of the file; one that another process made there meanwhile may not, as it has none of the jobs.
"""

from __future__ import annotations

import logging
import os
import sqlite3
from contextlib import closing, suppress
from pathlib import Path
from stat import S_ISREG
from threading import Lock
from typing import Any

from sqlalchemy import Engine, event
from sqlalchemy.exc import InvalidatePoolError

from safestart.store.schema import HEAD

log = logging.getLogger("safestart.store")

_MARK = "safestart.file"
_TRIES = 3
_MODE = 0o644  # as SQLite makes them

Identity = tuple[int, int]
"""Device and inode: the file itself, whatever its name."""


class SameFile:
    """Watches the file at ``path`` for the connections of one engine."""

    def __init__(self, engine: Engine, path: Path, shown: str) -> None:
        self._path, self._shown = path.absolute(), shown
        self._known: Identity | None = None
        self._name = 0
        self._away = False
        self._lock = Lock()
        event.listen(engine, "do_connect", self._connect)
        event.listen(engine, "checkout", self._check)

    def forked(self) -> None:
        """This process is a child: a thread of the parent may have held the lock."""
        self._lock = Lock()

    def make(self) -> None:
        """Make an empty file where none is and none was; a path that cannot be is reported by the connection."""
        if self._known is None and not self._is_no_file():
            with suppress(OSError):
                os.close(os.open(self._path, os.O_CREAT | os.O_WRONLY, _MODE))

    def learn(self, engine: Engine) -> None:
        """Read the name of the database, which its first migration gives it."""
        with engine.connect() as connection:
            self._name = int(connection.exec_driver_sql("PRAGMA user_version").scalar_one())

    def _connect(
        self, dialect: Any, record: Any, _arguments: Any, options: dict[str, Any]
    ) -> sqlite3.Connection:
        """Open the file that is there, never a new one, and remember which one it is."""
        if self._is_no_file():  # SQLite would wait for whoever opens the other end of a pipe
            raise sqlite3.OperationalError("a regular file is required at its path")
        for _ in range(_TRIES):
            before = self._there()
            if before is None and self._known is not None:
                raise sqlite3.OperationalError("its file was moved or deleted")
            opened: sqlite3.Connection = dialect.connect(
                f"{self._path.as_uri()}?mode=rw", **options, uri=True
            )
            if before is not None and before == self._there():
                self._meet(before, opened)
                record.info[_MARK] = before
                return opened
            opened.close()  # it was changed just then, so nobody knows which one this is
        raise sqlite3.OperationalError("the file at its path changes again and again")

    def _check(self, _connection: Any, record: Any, _proxy: Any) -> None:
        """Before every transaction: about a microsecond. The pool drops its connections and makes a new one."""
        if self._there() != record.info.get(_MARK):
            self._lost()
            raise InvalidatePoolError

    def _there(self) -> Identity | None:
        try:
            found = os.stat(self._path)
        except OSError:
            return None
        return found.st_dev, found.st_ino

    def _is_no_file(self) -> bool:
        try:
            return not S_ISREG(os.stat(self._path).st_mode)
        except OSError:
            return False

    def _meet(self, found: Identity, opened: sqlite3.Connection) -> None:
        """Take another file in the place of the known one only if it is a copy of it, at our schema."""
        with self._lock:
            if self._known != found:
                name, version = _read(opened)
                if self._known is not None and (name, version) != (self._name, HEAD):
                    opened.close()
                    raise sqlite3.OperationalError(
                        "another file is at its path, and it is no copy of the database at this version's schema; "
                        "a restart would take it"
                    )
                self._known, self._name = found, name
            if self._away:
                log.info("a file is at the path of the database %s again", self._shown)
            self._away = False

    def _lost(self) -> None:
        with self._lock:
            if not self._away:
                log.error(
                    "the file of the database %s was moved, deleted or replaced; required: the file at its path",
                    self._shown,
                )
            self._away = True


def _read(opened: sqlite3.Connection) -> tuple[int, str | None]:
    """Name and schema of a database; no schema for what is none of ours."""
    with suppress(sqlite3.DatabaseError):
        name = int(opened.execute("PRAGMA user_version").fetchone()[0])
        with closing(opened.execute("SELECT version_num FROM alembic_version")) as rows:
            found = rows.fetchone()
        return name, None if found is None else str(found[0])
    return 0, None
