"""The databases the store's contract runs on: SQLite always, PostgreSQL where a server is named."""

from __future__ import annotations

import atexit
import os
from datetime import timedelta
from pathlib import Path
from uuid import uuid4

import pytest
from sqlalchemy import URL, create_engine, make_url, select, text

from safestart.store.database import Database
from safestart.store.dialect import UtcTime
from safestart.store.models import Base

# SQLAlchemy URL of a server on which a database may be created, e.g. postgresql://user:password@host/postgres
POSTGRESQL = os.environ.get("SAFESTART_TEST_POSTGRESQL", "")
NO_SERVER = "no PostgreSQL server: SAFESTART_TEST_POSTGRESQL names none"
BACKENDS = (
    "sqlite",
    pytest.param("postgresql", marks=pytest.mark.skipif(not POSTGRESQL, reason=NO_SERVER)),
)


def fresh_url(backend: str, folder: Path) -> str:
    """URL of an empty database."""
    if backend == "sqlite":
        return f"sqlite:///{folder / 'store.sqlite3'}"
    server = make_url(POSTGRESQL).set(drivername="postgresql+psycopg")
    name = f"safestart_{uuid4().hex}"
    engine = create_engine(server, isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        connection.execute(text(f"CREATE DATABASE {name}"))
    engine.dispose()
    atexit.register(_drop, server, name)
    return server.set(database=name).render_as_string(hide_password=False)


def ask(database: Database) -> None:
    """Query the database; raises ``Unavailable`` when no answer comes."""
    with database.session() as session:
        session.execute(text("SELECT 1"))


def pass_time(database: Database, seconds: float) -> None:
    """As if ``seconds`` had passed, or the clock been set: every time that is written moves back by as much."""
    with database.session(write=True) as session:
        for mapper in Base.registry.mappers:
            names = [column.key for column in mapper.columns if isinstance(column.type, UtcTime)]
            for row in session.scalars(select(mapper.class_)):
                for name in names:
                    written = getattr(row, name)
                    if written is not None:
                        setattr(row, name, written - timedelta(seconds=seconds))


def _drop(server: URL, name: str) -> None:
    engine = create_engine(server, isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        connection.execute(text(f"DROP DATABASE IF EXISTS {name} WITH (FORCE)"))
    engine.dispose()
