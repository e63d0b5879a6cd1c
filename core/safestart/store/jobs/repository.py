"""The jobs: one repository for submission, reading, claims, events and workers."""

from __future__ import annotations

from base64 import urlsafe_b64decode, urlsafe_b64encode
from dataclasses import fields
from typing import Any

from sqlalchemy import Row, exists, func, select
from sqlalchemy.orm import Session

from safestart.errors import InvalidInput, invalid
from safestart.store.dialect import after
from safestart.store.jobs.conditions import conditions
from safestart.store.jobs.events import EventLog
from safestart.store.jobs.filters import EVERY, JobFilter
from safestart.store.jobs.submissions import Submissions, find
from safestart.store.models import JobRow, table
from safestart.store.queue.claims import Claims
from safestart.store.queue.places import Queue, runs
from safestart.store.queue.presence import Presence, crew_of
from safestart.store.queue.shards import Shards
from safestart.store.queue.tally import tallies
from safestart.store.records import Job, JobEntry, JobPage, JobStatus, Vitals

MAX_PAGE = 1000
_BEFORE, _AFTER = "before:", "after:"
_ENTRY = tuple(table(JobRow).c[name] for name in ("seq", *(field.name for field in fields(JobEntry))))


class JobRepository(Submissions, Claims, Shards, Queue, EventLog, Presence):
    """All operations on jobs; safe to share between threads."""

    def get(self, job_id: str) -> Job:
        """The job; raises ``NotFound``."""
        with self._database.session() as session:
            return find(session, job_id).record()

    def list(
        self,
        wanted: JobFilter = EVERY,
        *,
        limit: int = 50,
        cursor: str | None = None,
    ) -> JobPage:
        """A page of the jobs that meet ``wanted``, newest first.

        Jobs submitted while a client pages never shift its pages. Raises ``InvalidInput`` on a cursor that
        did not come from here.
        """
        if not 1 <= limit <= MAX_PAGE:
            raise invalid("limit", f"an integer in [1, {MAX_PAGE}]", limit)
        newer, seq = (False, None) if cursor is None else _decode(cursor)
        query = select(*_ENTRY).where(*conditions(wanted)).limit(limit + 1)
        if seq is not None:
            query = query.where(JobRow.seq > seq if newer else JobRow.seq < seq)
        with self._database.session() as session:
            rows = list(session.execute(query.order_by(JobRow.seq if newer else JobRow.seq.desc())))
            more = len(rows) > limit
            rows = rows[:limit][::-1] if newer else rows[:limit]
            if not rows or seq is None:
                others = False
            else:  # on the side that the client came from
                beyond = JobRow.seq < rows[-1].seq if newer else JobRow.seq > rows[0].seq
                others = bool(session.scalar(select(exists().where(*conditions(wanted), beyond))))
        older, later = (others, more) if newer else (more, others)
        return JobPage(
            tuple(_entry(row) for row in rows),
            _encode(_BEFORE, rows[-1].seq) if older else None,
            _encode(_AFTER, rows[0].seq) if later else None,
        )

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


def _entry(row: Row[Any]) -> JobEntry:
    values = {field.name: getattr(row, field.name) for field in fields(JobEntry)}
    return JobEntry(**values | {"status": JobStatus(row.status)})


def counts(session: Session) -> dict[str, int]:
    """Number of jobs by status, in this transaction."""
    query = select(JobRow.status, func.count()).group_by(JobRow.status)
    found = {status: number for status, number in session.execute(query)}
    return {status.value: found.get(status.value, 0) for status in JobStatus}


def _encode(kind: str, seq: int) -> str:
    return urlsafe_b64encode(f"{kind}{seq}".encode()).decode().rstrip("=")


def _decode(cursor: str) -> tuple[bool, int]:
    """Direction and start of a page: True for newer jobs, and the number of the job beside the page."""
    required = "the next_cursor or prev_cursor of an earlier page"
    try:
        text = urlsafe_b64decode(cursor + "=" * (-len(cursor) % 4)).decode("ascii")
    except ValueError:
        raise invalid("cursor", required, cursor) from None
    newer = text.startswith(_AFTER)
    number = text.removeprefix(_AFTER if newer else _BEFORE)
    if number == text or not (number.isascii() and number.isdigit()) or len(number) > 18:
        raise InvalidInput(
            f"cursor: required {required}, received {cursor!r}",
            field="cursor",
            required=required,
            received=cursor,
        )
    return newer, int(number)
