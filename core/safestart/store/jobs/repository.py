"""The jobs: one repository for submission, reading, claims, events and workers."""

from __future__ import annotations

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from safestart.store.dialect import after
from safestart.store.jobs.durations import Past
from safestart.store.jobs.events import EventLog
from safestart.store.jobs.finding import find
from safestart.store.jobs.listing import Listing
from safestart.store.jobs.submissions import Submissions
from safestart.store.models import JobRow
from safestart.store.queue.claims import Claims
from safestart.store.queue.places import Queue, runs
from safestart.store.queue.presence import Presence, crew_of
from safestart.store.queue.shards import Shards
from safestart.store.queue.tally import tallies
from safestart.store.records import Job, JobStatus, Vitals


class JobRepository(Submissions, Listing, Past, Claims, Shards, Queue, EventLog, Presence):
    """All operations on jobs; safe to share between threads."""

    def get(self, job_id: str) -> Job:
        """The job; raises ``NotFound``."""
        with self._database.session() as session:
            return find(session, job_id).record()

    def vitals(self) -> Vitals:
        """The values behind the metrics, read in one transaction."""
        with self._database.session() as session:
            oldest = session.execute(
                select(JobRow.created_at, after().label("now"))
                .where(JobRow.status == JobStatus.ACCEPTED.value)
                .order_by(JobRow.seq)
                .limit(1)
            ).one_or_none()
            waited = 0.0 if oldest is None else max((oldest.now - oldest.created_at).total_seconds(), 0.0)
            return Vitals(counts(session), crew_of(session), waited, tallies(session), runs(session))

    def tallies(self) -> dict[str, int]:
        """Counters of rare events, by name (see ``tally``)."""
        with self._database.session() as session:
            return tallies(session)

    def counts(self) -> dict[str, int]:
        """Number of jobs by status; every status is there."""
        with self._database.session() as session:
            return counts(session)


def counts(session: Session) -> dict[str, int]:
    """Number of jobs by status, in this transaction."""
    query = select(JobRow.status, func.count()).group_by(JobRow.status)
    found = {status: number for status, number in session.execute(query)}
    return {status.value: found.get(status.value, 0) for status in JobStatus}
