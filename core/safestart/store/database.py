"""The database: its engine, its sessions, and the only place that turns database errors into ours."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from threading import Lock
from typing import Any

from sqlalchemy import Connection, Engine, Pool, create_engine
from sqlalchemy.engine import URL
from sqlalchemy.exc import ArgumentError, DBAPIError, OperationalError, SQLAlchemyError
from sqlalchemy.exc import TimeoutError as NoConnection
from sqlalchemy.orm import Session

from safestart.errors import Away, Unavailable
from safestart.runtime.children.forks import Forkable
from safestart.store import schema
from safestart.store.dialect import BUSY_TIMEOUT_S, prepare
from safestart.store.same_file import SameFile
from safestart.store.url import REQUIRED, parse, refused, shown, without_secrets

# libpq's messages for errors that waiting cannot cure; at that stage there are no error codes.
_REFUSALS = (
    "authentication failed",
    "no password supplied",
    "does not exist",
    "no pg_hba.conf entry",
    "permission denied",
    "not permitted",
    "does not support SSL",
    "invalid",
)


class Database(Forkable):
    """An SQLAlchemy URL with sessions; connecting happens at first use."""

    def __init__(self, url: str) -> None:
        self._url = parse(url)
        self.shown = shown(self._url)
        self._engine = _engine(self._url)
        prepare(self._engine)
        self._watched = None if self.file is None else SameFile(self._engine, self.file, self.shown)
        # Same pool; with this option SQLite takes the write lock at the start of the transaction.
        self._writer = self._engine.execution_options(safestart_write=True)
        self._writing = Lock()
        self._parents: list[Pool] = []
        self.tell_of_forks()

    @contextmanager
    def session(self, *, write: bool = False) -> Iterator[Session]:
        """One transaction: committed at the end, rolled back on any error; raises ``Unavailable``.

        A session that changes anything says ``write=True``.
        """
        with (
            self._turn() if write and self.one_writer else nullcontext(),
            self._translated(),
            Session(self._writer if write else self._engine, expire_on_commit=False) as session,
            session.begin(),
        ):
            yield session

    @property
    def one_writer(self) -> bool:
        """True when a transaction that may write blocks all other writers."""
        return self._engine.dialect.name == "sqlite"

    @property
    def file(self) -> Path | None:
        """The file of a SQLite database; None for other databases."""
        sqlite = self._url.get_backend_name() == "sqlite"
        return Path(str(self._url.database)) if sqlite else None

    @contextmanager
    def snapshot(self) -> Iterator[Connection]:
        """A read-only connection that sees one snapshot of the database while it is open."""
        with self._translated(), self._engine.connect() as connection:
            if connection.dialect.name == "postgresql":
                connection = connection.execution_options(isolation_level="REPEATABLE READ")
            with connection.begin():
                yield connection

    def migrate(self) -> None:
        """Migrate the schema to this version's; safe when several processes do it at once.

        Nothing else makes the file of a SQLite database.
        """
        if self._watched is not None:
            self._watched.make()
        with self._translated():
            schema.migrate(self._writer)
            if self._watched is not None:
                self._watched.learn(self._engine)

    def close(self) -> None:
        """Close every pooled connection."""
        self._engine.dispose()

    def forking(self) -> None:
        """Leave no open connection to the child: what SQLite knows of its own locks would not be true there."""
        self._engine.dispose()

    def forked(self) -> None:
        """Connect anew. Those of a session that was under way stay open: to close them would end the parent's."""
        self._parents.append(self._engine.pool)
        self._engine.dispose(close=False)
        self._writing = Lock()
        if self._watched is not None:
            self._watched.forked()

    @contextmanager
    def _turn(self) -> Iterator[None]:
        """Writers to SQLite queue here: inside SQLite they would sleep for longer and longer times between tries."""
        mine = self._writing.acquire(timeout=BUSY_TIMEOUT_S)  # then SQLite itself reports that it is busy
        try:
            yield
        finally:
            if mine:
                self._writing.release()

    @contextmanager
    def _translated(self) -> Iterator[None]:
        try:
            yield
        except SQLAlchemyError as error:
            raise self._unavailable(error) from error

    def _unavailable(self, error: SQLAlchemyError) -> Unavailable:
        # Never str(error): it contains the statement and its parameters.
        reason = str(error.orig) if isinstance(error, DBAPIError) else type(error).__name__
        if isinstance(error, NoConnection):
            reason = "all connections of this process are in use"
        reason = without_secrets(" ".join(reason.split()), self._url)
        kind = Away if self._url.get_backend_name() == "postgresql" and _away(error) else Unavailable
        return kind(
            f"the database {self.shown} did not do what was asked: {reason}; required: {REQUIRED}",
            field="database_url",
            required=REQUIRED,
            received=self.shown,
        )


def _away(error: SQLAlchemyError) -> bool:
    """True when a PostgreSQL server is unreachable, starting or stopping; False when it refuses us."""
    if not isinstance(error, OperationalError):
        return False
    state = getattr(error.orig, "sqlstate", None)
    if state is not None:
        return str(state)[:2] == "08" or str(state)[:3] in ("57P", "533")
    return not any(words in str(error.orig) for words in _REFUSALS)


def _dumps(value: object) -> str:
    return json.dumps(value, separators=(",", ":"), allow_nan=False)


def _options(backend: str) -> dict[str, Any]:
    if backend == "sqlite":
        return {"timeout": BUSY_TIMEOUT_S}
    from safestart.store.session import CONNECTION  # SQLite does without psycopg

    return CONNECTION


def _engine(url: URL) -> Engine:
    try:
        options = _options(url.get_backend_name())
        ours = {name: value for name, value in options.items() if name not in url.query}
        return create_engine(url, json_serializer=_dumps, connect_args=ours)
    except ModuleNotFoundError as error:
        raise Unavailable(
            f"a {url.get_backend_name()} database requires the package {error.name}, which is not installed",
            field="database_url",
            required=f"the package {error.name}",
        ) from None
    except (ArgumentError, SQLAlchemyError):
        raise refused(shown(url)) from None
