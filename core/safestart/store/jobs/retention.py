"""Delete jobs that ended long ago, with everything that belongs to them."""

from __future__ import annotations

from time import monotonic, sleep

from sqlalchemy import ColumnElement, delete, func, select

from safestart.store.database import Database
from safestart.store.dialect import after
from safestart.store.models import Base, JobRow
from safestart.store.records import JobStatus

# Target length of a transaction, s; a pause at least as long follows, in which others can write. The number of jobs
# in a transaction adapts, as it depends on the sizes of their artifacts.
_BRIEF_S = 0.2
_PAUSE_S = 0.05
_FEW, _MANY = 10, 200
_ENDED = tuple(status.value for status in JobStatus if status.ended)


class Retention:
    """Counts and deletes old jobs."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def older(self, than_s: float) -> int:
        """Number of jobs that ended more than ``than_s`` seconds ago, by the database's clock."""
        with self._database.session() as session:
            return session.scalar(select(func.count()).where(*_old(than_s))) or 0

    def purge(self, than_s: float) -> int:
        """Delete them with results, artifacts and events; returns their number. Pauses half the time for others."""
        done, batch = 0, _FEW
        while True:
            start = monotonic()
            found = self._delete(than_s, batch)
            took = monotonic() - start
            done += found
            if found < batch:
                return done
            batch = min(2 * batch, _MANY) if took < _BRIEF_S else max(batch // 2, 1)
            sleep(max(took, _PAUSE_S))

    def _delete(self, than_s: float, most: int) -> int:
        # On PostgreSQL two purges at the same time delete different jobs.
        query = select(JobRow.id).where(*_old(than_s)).limit(most).with_for_update(skip_locked=True)
        jobs = Base.metadata.tables["jobs"].c.id
        with self._database.session(write=True) as session:
            ids = session.scalars(query).all()
            for table in reversed(Base.metadata.sorted_tables):
                for key in table.foreign_keys:
                    if key.column is jobs:
                        session.execute(delete(table).where(key.parent.in_(ids)))
            session.execute(delete(JobRow).where(JobRow.id.in_(ids)))
        return len(ids)


def _old(than_s: float) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
    # PostgreSQL evaluates a subquery once and can then use the index; its clock function would be evaluated per row.
    return JobRow.status.in_(_ENDED), JobRow.finished_at < select(after(-than_s)).scalar_subquery()
