"""All differences between SQLite and PostgreSQL: the clock, the kind of transaction, the schema lock.

Leases use the database's clock, never a client's: workers on several machines then agree on who holds a job, even
if their own clocks differ.
"""

from __future__ import annotations

import secrets
import select
import sqlite3
import time
from datetime import UTC, datetime
from typing import Any, cast

from sqlalchemy import Connection, DateTime, Dialect, Engine, event, text
from sqlalchemy.exc import InvalidatePoolError
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.sql.expression import ColumnElement, literal
from sqlalchemy.sql.functions import FunctionElement
from sqlalchemy.types import Float, Integer, String, TypeDecorator

BUSY_TIMEOUT_S = 30.0
_WAL_BYTES = 64 * 1024 * 1024
_SCHEMA_LOCK = 0x5AFE57A27
_QUEUE_LOCK = 0x5AFE57A28
# SQLite stores times as text; this is SQLAlchemy's layout, in which text order is time order.
_SQLITE_TIME = "'%Y-%m-%d %H:%M:%f000', 'now'"


class UtcTime(TypeDecorator[datetime]):
    """A timezone-aware UTC time; SQLite stores it without zone, so reading adds the zone again."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:  # noqa: ARG002
        """Turn an aware time into UTC; a naive time is a mistake in our code."""
        if value is None:
            return None
        if value.tzinfo is None:
            raise ValueError("a timezone-aware time is required")
        return value.astimezone(UTC)

    def process_result_value(self, value: Any, dialect: Dialect) -> datetime | None:  # noqa: ARG002
        """Return an aware UTC time."""
        if value is None:
            return None
        read: datetime = value
        return read.replace(tzinfo=UTC) if read.tzinfo is None else read.astimezone(UTC)


class _After(FunctionElement[datetime]):
    """The database's current time plus its one argument in seconds."""

    type = UtcTime()
    inherit_cache = True
    name = "safestart_after"


def after(seconds: float | ColumnElement[Any] = 0.0) -> ColumnElement[datetime]:
    """The database's clock, ``seconds`` from now (negative: ago)."""
    return _After(literal(float(seconds), Float()) if isinstance(seconds, int | float) else seconds)


@compiles(_After, "sqlite")
def _after_sqlite(element: _After, compiler: Any, **kw: Any) -> str:
    seconds = compiler.process(element.clauses, **kw)
    return f"strftime({_SQLITE_TIME}, ({seconds}) || ' seconds')"


@compiles(_After, "postgresql")
def _after_postgresql(element: _After, compiler: Any, **kw: Any) -> str:
    seconds = compiler.process(element.clauses, **kw)
    # clock_timestamp, not now(): the latter stands still during a transaction.
    return f"(clock_timestamp() + make_interval(secs => {seconds}))"


class _PlaceOf(FunctionElement[int]):
    """Where the second argument first occurs in the first, a text, from 1 on; 0: nowhere."""

    type = Integer()
    inherit_cache = True
    name = "safestart_place_of"


def holds(text_: ColumnElement[str], part: str) -> ColumnElement[bool]:
    """Whether a text has a part, letter by letter: in half the time that PostgreSQL needs for LIKE."""
    return _PlaceOf(text_, literal(part, String())) > 0


@compiles(_PlaceOf, "sqlite")
def _place_of_sqlite(element: _PlaceOf, compiler: Any, **kw: Any) -> str:
    return f"instr({compiler.process(element.clauses, **kw)})"


@compiles(_PlaceOf, "postgresql")
def _place_of_postgresql(element: _PlaceOf, compiler: Any, **kw: Any) -> str:
    return f"strpos({compiler.process(element.clauses, **kw)})"


class _SecondsBetween(FunctionElement[float]):
    """Second argument minus first, both times, in seconds."""

    type = Float()
    inherit_cache = True
    name = "safestart_seconds_between"


def seconds_between(start: Any, end: Any) -> ColumnElement[float]:
    """Seconds from ``start`` to ``end``; NULL when either is NULL. SQLite has millisecond resolution."""
    return _SecondsBetween(start, end)


@compiles(_SecondsBetween, "sqlite")
def _seconds_between_sqlite(element: _SecondsBetween, compiler: Any, **kw: Any) -> str:
    start, end = (compiler.process(clause, **kw) for clause in element.clauses)
    return f"((julianday({end}) - julianday({start})) * 86400.0)"


@compiles(_SecondsBetween, "postgresql")
def _seconds_between_postgresql(element: _SecondsBetween, compiler: Any, **kw: Any) -> str:
    start, end = (compiler.process(clause, **kw) for clause in element.clauses)
    return f"extract(epoch from ({end} - {start}))"


def storable(message: str) -> str:
    """A text that both databases accept: PostgreSQL refuses NUL, and both refuse half a surrogate pair."""
    return message.encode("utf-8", "replace").decode("utf-8").replace("\0", "?")


def prepare(engine: Engine) -> None:
    """Install the event handlers that this dialect needs for new connections and new transactions."""
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _on_sqlite_connect)
        event.listen(engine, "begin", _on_sqlite_begin)
    else:
        event.listen(engine, "do_connect", _do_postgresql_connect)
        event.listen(engine, "checkout", _on_postgresql_checkout)


def _on_sqlite_connect(connection: sqlite3.Connection, _record: Any) -> None:
    connection.isolation_level = None  # the driver must not begin transactions of its own
    cursor = connection.cursor()
    cursor.execute(f"PRAGMA busy_timeout = {int(BUSY_TIMEOUT_S * 1000)}")
    cursor.execute("PRAGMA foreign_keys = ON")
    # FULL: a submission survives a power cut once it is answered.
    cursor.execute("PRAGMA synchronous = FULL")
    # Lets the -wal file shrink after a large transaction.
    cursor.execute(f"PRAGMA journal_size_limit = {_WAL_BYTES}")
    deadline = time.monotonic() + BUSY_TIMEOUT_S
    while cursor.execute("PRAGMA journal_mode").fetchone()[0] != "wal":
        try:
            cursor.execute("PRAGMA journal_mode = WAL").fetchone()
        except sqlite3.OperationalError as error:
            # SQLite does not wait when another process switches at the same moment.
            if "locked" not in str(error) or time.monotonic() > deadline:
                raise
            time.sleep(0.02)
    cursor.close()


def _do_postgresql_connect(_dialect: Any, _record: Any, arguments: Any, options: Any) -> Any:
    from safestart.store.patient import PatientConnection  # SQLite does without psycopg
    from safestart.store.session import settle

    connection = PatientConnection.connect(*arguments, **options)
    try:
        settle(connection, BUSY_TIMEOUT_S)  # before SQLAlchemy reads anything through it
    except BaseException:
        connection.close()
        raise
    return connection


def _on_postgresql_checkout(connection: Any, _record: Any, _proxy: Any) -> None:
    # An idle connection becomes readable only when its server has closed it. This check costs no round trip, unlike
    # a query before every transaction. The pool then drops its connections and makes a new one.
    if not connection.closed:
        connection.patience_s = type(connection).patience_s
        heard = select.poll()
        heard.register(connection, select.POLLIN)
        if not heard.poll(0):
            return
    raise InvalidatePoolError


def _on_sqlite_begin(connection: Connection) -> None:
    # Two transactions that read first and write later can deadlock; IMMEDIATE makes them queue.
    write = connection.get_execution_options().get("safestart_write", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if write else "BEGIN DEFERRED")


def lock_schema(connection: Connection) -> None:
    """Take the schema lock for this transaction, waiting without limit: every migration ends by itself."""
    if connection.dialect.name == "postgresql":
        from safestart.store.patient import MIGRATION_S

        connection.execute(text("SET LOCAL lock_timeout = 0"))
        connection.execute(text("SET LOCAL statement_timeout = 0"))
        cast(Any, connection.connection.driver_connection).patience_s = MIGRATION_S
    _wait_for(connection, _SCHEMA_LOCK)


def name_database(connection: Connection) -> None:
    """Give a new SQLite database a number of its own, which its copies keep: see ``same_file``."""
    if connection.dialect.name == "sqlite":
        connection.exec_driver_sql(f"PRAGMA user_version = {1 + secrets.randbelow(2**31 - 1)}")


def lock_queue(connection: Connection) -> None:
    """Take the submission lock for this transaction, so that counts stay true until the job is added."""
    _wait_for(connection, _QUEUE_LOCK)


def _wait_for(connection: Connection, key: int) -> None:
    # On SQLite BEGIN IMMEDIATE has done that.
    if connection.dialect.name == "postgresql":
        connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": key})
