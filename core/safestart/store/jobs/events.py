"""Events of jobs: written with each change, read by those who follow a job."""

from __future__ import annotations

from typing import Any

from sqlalchemy import insert, select
from sqlalchemy.orm import Session

from safestart.store.database import Database
from safestart.store.dialect import after
from safestart.store.models import EventRow, table
from safestart.store.records import Event, JobStatus

_ADD = insert(table(EventRow)).values(at=after()).inline()


def add_event(session: Session, job_id: str, kind: str, data: dict[str, Any]) -> None:
    """Append one event, in the transaction that changes the job."""
    session.execute(_ADD, {"job_id": job_id, "kind": kind, "data": data})


def add_status(session: Session, job_id: str, status: JobStatus, **more: Any) -> None:
    """Append the event of a change of status."""
    add_event(session, job_id, "status", {"status": status.value, **more})


class EventLog:
    """Reading side of the events."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def events(self, job_id: str, after_id: int = 0, limit: int = 500) -> tuple[Event, ...]:
        """Events of a job with ids above ``after_id``, oldest first; none for an unknown job."""
        query = (
            select(EventRow)
            .where(EventRow.job_id == job_id, EventRow.id > after_id)
            .order_by(EventRow.id)
            .limit(limit)
        )
        with self._database.session() as session:
            return tuple(row.record() for row in session.scalars(query))
