"""The worker's side of the queue: claim with a lease, renew it, report, end.

Every change is one conditional update on the claim's token: a worker that lost its lease changes nothing and gets
``LeaseLost``.
"""

from __future__ import annotations

from typing import Any

from sqlalchemy import ColumnElement, Row, Select, Update, bindparam, delete, func, select, update
from sqlalchemy.orm import Session

from safestart.records.artifact import Artifact
from safestart.store.database import Database
from safestart.store.dialect import after, storable
from safestart.store.jobs.events import add_event, add_status
from safestart.store.jobs.writing import add_result
from safestart.store.models import JobRow, ShardRow, table
from safestart.store.queue.holding import FREE, HELD, JOBS, LEASE, WANTED, change, try_change
from safestart.store.queue.lease import expired
from safestart.store.queue.poison import TASK_PROCESS, WORKER, add_lost, poison
from safestart.store.queue.tally import Tally, count
from safestart.store.records import Claim, JobStatus

_RENEWED = HELD.values(LEASE)
_ENDED = HELD.values(finished_at=after())
_ENDED_WANTED = WANTED.values(finished_at=after())
_RELEASED = WANTED.values(attempts=JOBS.c.attempts - 1)
_ASKED = select(JOBS.c.cancel_requested).where(JOBS.c.id == bindparam("job"))
_SHARDS_OF = delete(table(ShardRow)).where(table(ShardRow).c.job_id == bindparam("job"))


class Claims:
    """Operations of a worker on its jobs."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def claim(
        self, owner: str, lease_s: float, max_attempts: int = 3, *, likely: bool = False
    ) -> Claim | None:
        """Take the next job, or return None: highest priority first, then by turn, then oldest.

        A running job whose lease ran out is taken over. If it has used up its attempts it ends failed, if its
        dismissal was requested it ends dismissed, and the search goes on. ``likely``: a job probably waits, so skip
        the read-only look beforehand.
        """
        if not likely and self._database.one_writer:
            with self._database.session() as session:
                # Look without the write lock: idle workers must not queue up behind each other.
                if _next(session) is None:
                    return None
        with self._database.session(write=True) as session:
            while (row := _next(session)) is not None:
                if row.cancel_requested:
                    _end_unheld(session, row, JobStatus.DISMISSED, message="dismissed")
                elif row.attempts >= max_attempts:
                    problem = poison(session, row.id, max_attempts)
                    if _end_unheld(
                        session, row, JobStatus.FAILED, message=problem["detail"], problem=problem
                    ):
                        count(session, Tally.POISONED)
                elif (claim := _take(session, row, owner, lease_s)) is not None:
                    return claim
        return None

    def next_process(self) -> str | None:
        """The process of the job that the next claim will find, or None; takes nothing."""
        with self._database.session() as session:
            row = _next(session)
            return None if row is None else str(row.process_id)

    def renew(self, claim: Claim, lease_s: float) -> bool:
        """Extend the lease. Returns False when the job's dismissal was requested, else True. Raises ``LeaseLost``."""
        with self._database.session(write=True) as session:
            change(session, claim, _RENEWED, lease_for=lease_s, lease_s=lease_s)
            return not session.scalar(_ASKED, {"job": claim.job_id})

    def progress(self, claim: Claim, percent: float, message: str, eta_s: float | None) -> None:
        """Write progress (0..100), message and estimated seconds left, and append the event."""
        with self._database.session(write=True) as session:
            change(session, claim, progress=percent, message=storable(message), eta_s=eta_s)
            data = {"progress": percent, "message": message, "eta_s": eta_s}
            add_event(session, claim.job_id, "progress", data)

    def log(self, claim: Claim, message: str) -> None:
        """Append a log event."""
        with self._database.session(write=True) as session:
            change(session, claim)
            add_event(session, claim.job_id, "log", {"message": message})

    def restarted(self, claim: Claim, max_attempts: int) -> bool:
        """Count a restart after the death of the job's task process, and reset its progress.

        Returns False when no attempt is left.
        """
        with self._database.session(write=True) as session:
            change(session, claim, progress=0.0, eta_s=None)
            attempts = session.scalar(select(JobRow.attempts).where(JobRow.id == claim.job_id)) or 0
            left = attempts < max_attempts
            if left:
                change(session, claim, attempts=attempts + 1, message=_starting(attempts + 1))
                add_lost(
                    session, claim.job_id, TASK_PROCESS, f"its task process died; {_starting(attempts + 1)}"
                )
            count(session, Tally.TASK_DEATHS)
            return left

    def poisoned(self, claim: Claim, max_attempts: int) -> None:
        """End the job as failed because its task processes died, or its workers were lost, too often."""
        with self._database.session(write=True) as session:
            add_lost(session, claim.job_id, TASK_PROCESS, "its task process died; no attempt is left")
            problem = poison(session, claim.job_id, max_attempts)
            if _end(session, claim, JobStatus.FAILED, message=problem["detail"], problem=problem):
                count(session, Tally.POISONED)

    def succeed(
        self,
        claim: Claim,
        document: dict[str, Any],
        artifacts: tuple[Artifact, ...],
        versions: dict[str, Any],
        outcome: dict[str, Any] | None = None,
    ) -> None:
        """Store result, artifacts and the result's outcome, and end the job, in one transaction.

        A job whose dismissal was requested ends dismissed, without a result, as its client was told.
        """
        with self._database.session(write=True) as session:
            values = {"progress": 100.0, "message": "done", "versions": versions}
            if outcome is not None:
                values |= {"outcome": outcome, "verdict": outcome["word"]}
            if _end(session, claim, JobStatus.SUCCESSFUL, **values):
                add_result(session, claim.job_id, document, artifacts)
                session.execute(_SHARDS_OF, {"job": claim.job_id})

    def fail(self, claim: Claim, problem: dict[str, Any]) -> None:
        """End the job as failed with a problem document, or as dismissed when that was requested."""
        message = storable(str(problem.get("detail") or problem.get("title") or "failed"))
        with self._database.session(write=True) as session:
            _end(session, claim, JobStatus.FAILED, message=message, problem=problem)

    def dismissed(self, claim: Claim) -> None:
        """End the job as dismissed, after its computation has stopped."""
        with self._database.session(write=True) as session:
            change(session, claim, cancel_requested=True)
            _end(session, claim, JobStatus.DISMISSED)

    def release(self, claim: Claim, reason: str) -> None:
        """Return the job to its old place in the queue, without counting an attempt."""
        with self._database.session(write=True) as session:
            values = {
                "status": JobStatus.ACCEPTED.value,
                "progress": 0.0,
                "message": reason,
                "started_at": None,
                **FREE,
            }
            if try_change(session, claim, _RELEASED, **values):
                add_status(session, claim.job_id, JobStatus.ACCEPTED, message=reason)
            else:
                _end(session, claim, JobStatus.DISMISSED)


_SEEN = tuple(
    JOBS.c[name]
    for name in (
        "seq", "id", "status", "priority", "turn", "owner", "token", "attempts", "cancel_requested",
        "process_id", "inputs", "timeout_s",
    )
)  # fmt: skip


def _first(condition: ColumnElement[bool]) -> Select[Any]:
    return (
        select(*_SEEN)
        .where(condition)
        .order_by(JobRow.priority.desc(), JobRow.turn, JobRow.seq)
        .limit(1)
        .with_for_update(skip_locked=True)  # PostgreSQL: skip jobs that another worker is taking
    )


_WAITS = JobRow.status == JobStatus.ACCEPTED.value
# Find the highest priority first; the rest can then be read in index order. Two queries, because a union could not
# use the index.
_HIGHEST = select(func.max(JobRow.priority)).where(_WAITS).scalar_subquery()
_CANDIDATES = (_first(_WAITS & (JobRow.priority == _HIGHEST)), _first(expired()))

_AS_SEEN = (
    update(JOBS)
    .where(
        JOBS.c.id == bindparam("seen_id"),
        JOBS.c.token == bindparam("seen_token"),
        JOBS.c.status == bindparam("seen_status"),
    )
    .values(updated_at=after())
)
_TAKEN = _AS_SEEN.values(LEASE | {"started_at": func.coalesce(JOBS.c.started_at, after())})
_ENDED_AS_SEEN = _AS_SEEN.values(finished_at=after())


def _next(session: Session) -> Row[Any] | None:
    """The job to serve next: the first that waits or whose lease ran out, whichever ranks higher."""
    found = [row for query in _CANDIDATES for row in session.execute(query)]
    return min(found, key=lambda row: (-row.priority, row.turn, row.seq), default=None)


def _take(session: Session, row: Row[Any], owner: str, lease_s: float) -> Claim | None:
    """Take the job if its row has not changed since we read it."""
    token, attempt = row.token + 1, row.attempts + 1
    values = {
        "status": JobStatus.RUNNING.value,
        "owner": owner,
        "token": token,
        "attempts": attempt,
        "progress": 0.0,
        "eta_s": None,
        "message": _starting(attempt),
        "lease_for": lease_s,
        "lease_s": lease_s,
    }
    lost_by = row.owner
    if not _if_as_seen(session, row, _TAKEN, values):
        return None
    if lost_by is not None:
        add_lost(
            session, row.id, WORKER, f"worker {lost_by} was lost: its lease ran out; {_starting(attempt)}"
        )
    add_status(session, row.id, JobStatus.RUNNING, attempt=attempt)
    if lost_by is not None:
        count(session, Tally.LEASE_LOSSES)
    return Claim(row.id, owner, token, row.process_id, row.inputs, attempt, row.timeout_s)


def _starting(attempt: int) -> str:
    return "starting" if attempt == 1 else f"starting, attempt {attempt}"


def _end_unheld(session: Session, row: Row[Any], status: JobStatus, **values: Any) -> bool:
    ended = {"status": status.value, "token": row.token + 1, **FREE, **values}
    if not _if_as_seen(session, row, _ENDED_AS_SEEN, ended):
        return False
    add_status(session, row.id, status, message=values["message"])
    return True


def _if_as_seen(session: Session, row: Row[Any], statement: Update, values: dict[str, Any]) -> bool:
    seen = {"seen_id": row.id, "seen_token": row.token, "seen_status": row.status}
    return bool(session.execute(statement, seen | values).rowcount)  # type: ignore[attr-defined]


def _end(session: Session, claim: Claim, status: JobStatus, **values: Any) -> bool:
    """End the claimed job as ``status``. If dismissal was requested, end it as dismissed and return False."""
    if try_change(session, claim, _ENDED_WANTED, status=status.value, **FREE, **values):
        more = {"message": values["message"]} if status is JobStatus.FAILED else {}
        add_status(session, claim.job_id, status, **more)
        return True
    change(session, claim, _ENDED, status=JobStatus.DISMISSED.value, message="dismissed", **FREE)
    add_status(session, claim.job_id, JobStatus.DISMISSED)
    return False
