"""Deleting what ended long ago, with everything that belongs to it."""

from __future__ import annotations

from sqlalchemy import ColumnElement, delete, func, select

from safestart.store.database import Database
from safestart.store.dialect import after
from safestart.store.models import Base, JobRow
from safestart.store.records import JobStatus

# Jobs per transaction: others write in between.
_BATCH = 200
_ENDED = tuple(status.value for status in JobStatus if status.ended)


class Retention:
    """How long ended jobs are kept."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def older(self, than_s: float) -> int:
        """How many jobs ended more than ``than_s`` seconds ago, on the database's clock."""
        with self._database.session() as session:
            return session.scalar(select(func.count()).where(*_old(than_s))) or 0

    def purge(self, than_s: float) -> int:
        """Delete them with results, artifacts and events; returns how many they were."""
        done = 0
        while True:
            with self._database.session(write=True) as session:
                ids = session.scalars(select(JobRow.id).where(*_old(than_s)).limit(_BATCH)).all()
                for table in reversed(Base.metadata.sorted_tables):
                    keys = [
                        key.parent
                        for key in table.foreign_keys
                        if key.column is Base.metadata.tables["jobs"].c.id
                    ]
                    for column in keys:
                        session.execute(delete(table).where(column.in_(ids)))
                session.execute(delete(JobRow).where(JobRow.id.in_(ids)))
            done += len(ids)
            if len(ids) < _BATCH:
                return done


def _old(than_s: float) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
    return JobRow.status.in_(_ENDED), JobRow.finished_at < after(-than_s)
