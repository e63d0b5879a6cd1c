"""Migrate the tables to this version's schema, in-process, with Alembic."""

from __future__ import annotations

from pathlib import Path

from sqlalchemy import Connection, Engine, inspect, text

from safestart.errors import Unavailable
from safestart.store.dialect import lock_schema, name_database

HEAD = "0007"
_MIGRATIONS = Path(__file__).parent / "migrations"


def migrate(writer: Engine) -> None:
    """Upgrade to :data:`HEAD` inside one transaction that holds the schema lock.

    An up-to-date schema, the usual case, costs one read and no import of Alembic.
    """
    with writer.begin() as connection:
        lock_schema(connection)
        found = version(connection)
        if found is None:
            name_database(connection)
        if found != HEAD:
            upgrade(connection)


def version(connection: Connection) -> str | None:
    """The database's revision; None for an empty database."""
    if not inspect(connection).has_table("alembic_version"):
        return None
    found: str | None = connection.execute(
        text("SELECT version_num FROM alembic_version")
    ).scalar_one_or_none()
    return found


def upgrade(connection: Connection, to: str = "head") -> None:
    """Run the migrations up to a revision; raises ``Unavailable`` for a schema newer than this version."""
    from alembic import command
    from alembic.config import Config
    from alembic.util import CommandError

    config = Config()
    config.set_main_option("script_location", str(_MIGRATIONS).replace("%", "%%"))
    config.attributes["connection"] = connection
    try:
        command.upgrade(config, to)
    except CommandError as error:
        raise Unavailable(
            f"the database is at a schema this version does not know ({error}); required: a safestart at "
            "least as new as the one that wrote it",
            field="database_url",
        ) from None
