"""Alembic's entry: it runs on the connection it is given, inside that connection's transaction."""

from alembic import context

from safestart.store.models import Base

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,
    transactional_ddl=True,
)
context.run_migrations()
