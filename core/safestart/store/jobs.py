"""The jobs: one repository for submission, reading, claims, events and workers."""

from __future__ import annotations

import builtins
from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Sequence
from datetime import datetime

from sqlalchemy import func, or_, select

from safestart.errors import InvalidInput, invalid
from safestart.store.claims import Claims
from safestart.store.events import EventLog
from safestart.store.models import JobRow
from safestart.store.presence import Presence
from safestart.store.records import Job, JobPage, JobStatus
from safestart.store.submissions import Submissions, find

MAX_PAGE = 1000
_CURSOR = "before:"


class JobRepository(Submissions, Claims, EventLog, Presence):
    """Everything there is to do with jobs; safe to share between threads."""

    def get(self, job_id: str) -> Job:
        """The job; raises ``NotFound``."""
        with self._database.session() as session:
            return find(session, job_id).record()

    def list(
        self,
        *,
        statuses: Sequence[JobStatus] = (),
        process_ids: Sequence[str] = (),
        limit: int = 50,
        cursor: str | None = None,
    ) -> JobPage:
        """A page of jobs, newest first, of the given statuses and processes (none given: all).

        Jobs submitted while a client pages never shift its pages. Raises ``InvalidInput`` on a cursor that
        did not come from here.
        """
        if not 1 <= limit <= MAX_PAGE:
            raise invalid("limit", f"an integer in [1, {MAX_PAGE}]", limit)
        query = select(JobRow).order_by(JobRow.seq.desc()).limit(limit + 1)
        if cursor is not None:
            query = query.where(JobRow.seq < _decode(cursor))
        if statuses:
            query = query.where(JobRow.status.in_([JobStatus(status).value for status in statuses]))
        if process_ids:
            query = query.where(JobRow.process_id.in_(process_ids))
        with self._database.session() as session:
            rows: builtins.list[JobRow] = builtins.list(session.scalars(query))
            more = len(rows) > limit
            rows = rows[:limit]
            return JobPage(tuple(row.record() for row in rows), _encode(rows[-1].seq) if more else None)

    def position(self, job_id: str) -> int | None:
        """Place in the queue, 1 = next; None unless the job waits. Raises ``NotFound``."""
        with self._database.session() as session:
            row = find(session, job_id)
            if row.status != JobStatus.ACCEPTED.value:
                return None
            ahead = select(func.count()).where(
                JobRow.status == JobStatus.ACCEPTED.value,
                or_(
                    JobRow.priority > row.priority,
                    (JobRow.priority == row.priority) & (JobRow.seq < row.seq),
                ),
            )
            return 1 + (session.scalar(ahead) or 0)

    def counts(self) -> dict[str, int]:
        """Number of jobs by status; every status is there."""
        query = select(JobRow.status, func.count()).group_by(JobRow.status)
        with self._database.session() as session:
            found = {status: number for status, number in session.execute(query)}
        return {status.value: found.get(status.value, 0) for status in JobStatus}

    def waiting_since(self) -> datetime | None:
        """When the oldest waiting job was submitted; None when none waits."""
        query = (
            select(JobRow.created_at)
            .where(JobRow.status == JobStatus.ACCEPTED.value)
            .order_by(JobRow.seq)
            .limit(1)
        )
        with self._database.session() as session:
            return session.scalar(query)


def _encode(seq: int) -> str:
    return urlsafe_b64encode(f"{_CURSOR}{seq}".encode()).decode().rstrip("=")


def _decode(cursor: str) -> int:
    required = "the next_cursor of an earlier page"
    try:
        text = urlsafe_b64decode(cursor + "=" * (-len(cursor) % 4)).decode("ascii")
    except ValueError:
        raise invalid("cursor", required, cursor) from None
    number = text.removeprefix(_CURSOR)
    if number == text or not (number.isascii() and number.isdigit()) or len(number) > 18:
        raise InvalidInput(
            f"cursor: required {required}, received {cursor!r}",
            field="cursor",
            required=required,
            received=cursor,
        )
    return int(number)
