"""The databases the store's contract runs on: SQLite always, PostgreSQL where a server is named."""

from __future__ import annotations

import os
from pathlib import Path
from uuid import uuid4

# SQLAlchemy URL of a server on which a database may be created, e.g. postgresql://user:password@host/postgres
POSTGRESQL = os.environ.get("SAFESTART_TEST_POSTGRESQL", "")
BACKENDS = ("sqlite", "postgresql") if POSTGRESQL else ("sqlite",)


def fresh_url(backend: str, folder: Path) -> str:
    """URL of an empty database."""
    if backend == "sqlite":
        return f"sqlite:///{folder / 'store.sqlite3'}"
    from sqlalchemy import create_engine, make_url, text

    server = make_url(POSTGRESQL).set(drivername="postgresql+psycopg")
    name = f"safestart_{uuid4().hex}"
    engine = create_engine(server, isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        connection.execute(text(f"CREATE DATABASE {name}"))
    engine.dispose()
    return server.set(database=name).render_as_string(hide_password=False)
