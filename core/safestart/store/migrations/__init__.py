"""Alembic migrations, run in-process by :mod:`safestart.store.schema`."""
