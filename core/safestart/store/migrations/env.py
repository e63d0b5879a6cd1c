"""Alembic's entry point: runs on the given connection, inside its transaction."""

from alembic import context

from safestart.store.models import Base

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,
    transactional_ddl=True,
)
context.run_migrations()
