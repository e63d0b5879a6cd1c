"""The worker's side of the queue: claim with a lease, renew it, report, end.

Every change is one conditional update that names the claim's token: a worker that lost its lease changes
nothing, and is told so with ``LeaseLost``.
"""

from __future__ import annotations

from typing import Any

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from safestart.artifact import Artifact
from safestart.errors import LeaseLost
from safestart.store.database import Database
from safestart.store.dialect import after
from safestart.store.events import add_event, add_status
from safestart.store.models import JobRow
from safestart.store.records import Claim, JobStatus
from safestart.store.writing import add_result

_FREE: dict[str, Any] = {"owner": None, "lease_expires_at": None, "eta_s": None}


class Claims:
    """Operations of a worker on the jobs it holds."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def claim(self, owner: str, lease_s: float, max_attempts: int = 3) -> Claim | None:
        """Take the next job, or None: highest priority first, then oldest.

        A running job whose lease ran out is taken over. One that has used up its attempts ends failed, and
        one whose dismissal was asked for ends dismissed, and the next is tried.
        """
        with self._database.session() as session:
            # A look without the write lock: idle workers must not queue up behind each other.
            if _next(session) is None:
                return None
        with self._database.session(write=True) as session:
            while (row := _next(session)) is not None:
                if row.cancel_requested:
                    _end_unheld(session, row, JobStatus.DISMISSED, message="dismissed")
                elif row.attempts >= max_attempts:
                    problem = _poison(row.attempts, max_attempts)
                    _end_unheld(session, row, JobStatus.FAILED, message=problem["detail"], problem=problem)
                elif (claim := _take(session, row, owner, lease_s)) is not None:
                    return claim
        return None

    def renew(self, claim: Claim, lease_s: float) -> bool:
        """Extend the lease. True: keep going; False: dismissal was asked for. Raises ``LeaseLost``."""
        with self._database.session(write=True) as session:
            _change(session, claim, lease_expires_at=after(lease_s))
            asked = session.scalar(select(JobRow.cancel_requested).where(JobRow.id == claim.job_id))
            return not asked

    def progress(self, claim: Claim, percent: float, message: str, eta_s: float | None) -> None:
        """Write progress (0..100), message and estimated seconds left, and append the event."""
        with self._database.session(write=True) as session:
            _change(session, claim, progress=percent, message=message, eta_s=eta_s)
            data = {"progress": percent, "message": message, "eta_s": eta_s}
            add_event(session, claim.job_id, "progress", data)

    def log(self, claim: Claim, message: str) -> None:
        """Append a log event."""
        with self._database.session(write=True) as session:
            _change(session, claim)
            add_event(session, claim.job_id, "log", {"message": message})

    def succeed(
        self,
        claim: Claim,
        document: dict[str, Any],
        artifacts: tuple[Artifact, ...],
        versions: dict[str, Any],
    ) -> None:
        """Store result and artifacts and end the job, in one transaction.

        A job whose dismissal was asked for ends dismissed, without a result: its client was told so.
        """
        with self._database.session(write=True) as session:
            values = {"progress": 100.0, "message": "done", "versions": versions}
            if _end(session, claim, JobStatus.SUCCESSFUL, **values):
                add_result(session, claim.job_id, document, artifacts)

    def fail(self, claim: Claim, problem: dict[str, Any]) -> None:
        """End the job as failed with a problem document (dismissed, when that was asked for)."""
        message = str(problem.get("detail") or problem.get("title") or "failed")
        with self._database.session(write=True) as session:
            _end(session, claim, JobStatus.FAILED, message=message, problem=problem)

    def dismissed(self, claim: Claim) -> None:
        """End the job as dismissed: its computation has stopped."""
        with self._database.session(write=True) as session:
            _change(session, claim, cancel_requested=True)
            _end(session, claim, JobStatus.DISMISSED)

    def release(self, claim: Claim, reason: str) -> None:
        """Give the job back to the queue, at its old place; this was no attempt."""
        with self._database.session(write=True) as session:
            values = {
                "status": JobStatus.ACCEPTED.value,
                "attempts": JobRow.attempts - 1,
                "progress": 0.0,
                "message": reason,
                "started_at": None,
                **_FREE,
            }
            if _try_change(session, claim, JobRow.cancel_requested.is_(False), **values):
                add_status(session, claim.job_id, JobStatus.ACCEPTED, message=reason)
            else:
                _end(session, claim, JobStatus.DISMISSED)


def _next(session: Session) -> JobRow | None:
    """The job to serve next: the first that waits or whose lease ran out, whichever ranks higher."""
    waits = JobRow.status == JobStatus.ACCEPTED.value
    expired = (JobRow.status == JobStatus.RUNNING.value) & (JobRow.lease_expires_at < after())
    found: list[JobRow] = []
    for condition in (waits, expired):  # two queries: each can use the queue's index, their union cannot
        query = (
            select(JobRow)
            .where(condition)
            .order_by(JobRow.priority.desc(), JobRow.seq)
            .limit(1)
            .with_for_update(skip_locked=True)  # PostgreSQL: pass over what another worker is taking
            .execution_options(populate_existing=True)
        )
        found += session.scalars(query).all()
    return min(found, key=lambda row: (-row.priority, row.seq), default=None)


def _take(session: Session, row: JobRow, owner: str, lease_s: float) -> Claim | None:
    """Make the job ours if it still is as we saw it."""
    token, attempt = row.token + 1, row.attempts + 1
    values = {
        "status": JobStatus.RUNNING.value,
        "owner": owner,
        "token": token,
        "attempts": attempt,
        "progress": 0.0,
        "eta_s": None,
        "message": "starting" if attempt == 1 else f"starting, attempt {attempt}",
        "lease_expires_at": after(lease_s),
        "started_at": func.coalesce(JobRow.started_at, after()),
    }
    if not _if_as_seen(session, row, values):
        return None
    add_status(session, row.id, JobStatus.RUNNING, attempt=attempt)
    return Claim(row.id, owner, token, row.process_id, row.inputs, attempt, row.timeout_s)


def _end_unheld(session: Session, row: JobRow, status: JobStatus, **values: Any) -> None:
    ended = {"status": status.value, "token": row.token + 1, "finished_at": after(), **_FREE, **values}
    if _if_as_seen(session, row, ended):
        add_status(session, row.id, status, message=values["message"])


def _if_as_seen(session: Session, row: JobRow, values: dict[str, Any]) -> bool:
    query = (
        update(JobRow)
        .where(JobRow.id == row.id, JobRow.token == row.token, JobRow.status == row.status)
        .values(updated_at=after(), **values)
        .execution_options(synchronize_session=False)
    )
    return bool(session.execute(query).rowcount)  # type: ignore[attr-defined]


def _try_change(session: Session, claim: Claim, *conditions: Any, **values: Any) -> bool:
    """Update the claimed job if the claim still holds (and ``conditions`` are met)."""
    query = (
        update(JobRow)
        .where(
            JobRow.id == claim.job_id,
            JobRow.status == JobStatus.RUNNING.value,
            JobRow.owner == claim.owner,
            JobRow.token == claim.token,
            *conditions,
        )
        .values(updated_at=after(), **values)
        .execution_options(synchronize_session=False)
    )
    return bool(session.execute(query).rowcount)  # type: ignore[attr-defined]


def _change(session: Session, claim: Claim, **values: Any) -> None:
    """Update the claimed job; raises ``LeaseLost``."""
    if not _try_change(session, claim, **values):
        raise LeaseLost(
            f"job {claim.job_id} is no longer held by {claim.owner}, claim {claim.token}; nothing written",
            required="a claim that still holds",
            received=claim.token,
        )


def _end(session: Session, claim: Claim, status: JobStatus, **values: Any) -> bool:
    """End the claimed job as ``status``; as dismissed when that was asked for, and then return False."""
    ended = {"finished_at": after(), **_FREE}
    if _try_change(
        session, claim, JobRow.cancel_requested.is_(False), status=status.value, **ended, **values
    ):
        more = {"message": values["message"]} if status is JobStatus.FAILED else {}
        add_status(session, claim.job_id, status, **more)
        return True
    _change(session, claim, status=JobStatus.DISMISSED.value, message="dismissed", **ended)
    add_status(session, claim.job_id, JobStatus.DISMISSED)
    return False


def _poison(attempts: int, most: int) -> dict[str, Any]:
    return {
        "type": "urn:safestart:problem:poison",
        "title": "Too many attempts",
        "status": 500,
        "detail": (
            f"the job was started {attempts} times and each time its worker was lost before it ended; "
            f"at most {most} attempts are made"
        ),
    }
