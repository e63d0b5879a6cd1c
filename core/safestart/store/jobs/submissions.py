"""The client's side of the queue: submit a job, dismiss it."""

from __future__ import annotations

from hashlib import sha256
from typing import Any
from uuid import uuid4

from sqlalchemy import func, or_, select, update
from sqlalchemy.orm import Session

from safestart.errors import Conflict, IdempotencyMismatch, InvalidInput, QueueFull
from safestart.records.comparable import canonical
from safestart.records.labels import NONE, Labels
from safestart.runtime.access import Caller
from safestart.store.access.audit import add_audit
from safestart.store.dialect import after, lock_queue
from safestart.store.jobs.events import add_event, add_status
from safestart.store.jobs.finding import find
from safestart.store.jobs.labelling import Labelling, searched
from safestart.store.models import JobRow
from safestart.store.queue.fairness import next_turn
from safestart.store.queue.lease import expired
from safestart.store.records import Job, JobStatus


class Submissions(Labelling):
    """Submit, label and dismiss."""

    def submit(
        self,
        process_id: str,
        inputs: dict[str, Any],
        *,
        instant: dict[str, Any] | None = None,
        timeout_s: float,
        idempotency_key: str | None = None,
        priority: int = 0,
        submitter: str = "",
        max_queued: int | None = None,
        by: Caller | None = None,
        job_id: str | None = None,
        labels: Labels = NONE,
    ) -> Job:
        """Put a job in the queue: higher ``priority`` first, among equals in fair turns by ``submitter``.

        The audit log records the caller ``by``. A new job gets ``job_id``, or a fresh id. The same
        ``idempotency_key`` of the same submitter with the same process and inputs returns the first job; with
        another process or inputs it raises ``IdempotencyMismatch``. A repeated ``job_id`` returns that job, and
        nothing else happens; with another process or inputs it raises ``Conflict``. Raises ``QueueFull`` when
        ``max_queued`` jobs wait already, and ``InvalidInput`` when the inputs are not JSON.
        """
        request = request_hash(process_id, inputs)
        if idempotency_key is not None and not 1 <= len(idempotency_key) <= 255:
            raise InvalidInput(
                f"idempotency key: required 1 to 255 characters, received {len(idempotency_key)}",
                field="Idempotency-Key",
                required="1 to 255 characters",
            )
        idempotency_key = _own_key(submitter, idempotency_key)
        with self._database.session(write=True) as session:
            # Otherwise two submissions at once would both find room, an unused key and the same turn.
            lock_queue(session.connection())
            again = None if job_id is None else session.scalar(select(JobRow).where(JobRow.id == job_id))
            if again is not None:
                return _repeated(again, request)
            first = _by_key(session, idempotency_key)
            if first is not None:
                return _same(first, request)
            if max_queued is not None:
                _require_room(session, max_queued)
            job_id = job_id or str(uuid4())
            row = JobRow(
                id=job_id,
                process_id=process_id,
                status=JobStatus.ACCEPTED.value,
                priority=priority,
                submitter=submitter,
                turn=next_turn(session, submitter, priority),
                inputs=inputs,
                instant=instant,
                idempotency_key=idempotency_key,
                request_sha256=request,
                timeout_s=timeout_s,
                created_at=after(),
                updated_at=after(),
                **labels.model_dump(),
                search=searched(job_id, process_id, labels.name, labels.tags),
            )
            session.add(row)
            session.flush()
            add_status(session, row.id, JobStatus.ACCEPTED)
            if by is not None:
                add_audit(session, by, "submit", row.id, {"process": process_id})
            return find(session, row.id).record()

    def dismiss(self, job_id: str, by: Caller | None = None) -> Job:
        """Dismiss a job: a waiting job ends at once; a running job is asked to stop and its worker ends it.

        The audit log records the caller ``by``. A running job whose lease ran out has no worker, so it ends at once
        too. Dismissing a job twice returns it; a job that ended otherwise raises ``Conflict``.
        """
        nobody_has_it = or_(
            JobRow.status == JobStatus.ACCEPTED.value,
            expired(),
        )
        end = (
            update(JobRow)
            .where(JobRow.id == job_id, nobody_has_it)
            .values(
                status=JobStatus.DISMISSED.value,
                token=JobRow.token + 1,  # from here on the store refuses a worker that was only slow
                cancel_requested=True,
                message="dismissed",
                eta_s=None,
                owner=None,
                lease_expires_at=None,
                lease_s=None,
                finished_at=after(),
                updated_at=after(),
            )
        )
        ask = (
            update(JobRow)
            .where(
                JobRow.id == job_id,
                JobRow.status == JobStatus.RUNNING.value,
                JobRow.cancel_requested.is_(False),
            )
            .values(cancel_requested=True, updated_at=after())
        )
        with self._database.session(write=True) as session:
            if session.execute(end).rowcount:  # type: ignore[attr-defined]
                add_status(session, job_id, JobStatus.DISMISSED)
                changed = True
            elif changed := bool(session.execute(ask).rowcount):  # type: ignore[attr-defined]
                add_event(session, job_id, "log", {"message": "dismissal requested"})
            if changed and by is not None:
                add_audit(session, by, "dismiss", job_id)
            job = find(session, job_id).record()
        if job.status in (JobStatus.SUCCESSFUL, JobStatus.FAILED):
            raise Conflict(
                f"job {job_id} has ended ({job.status.value}); required an accepted or running job",
                field="jobID",
                required="an accepted or running job",
                received=job.status.value,
            )
        return job


def request_hash(process_id: str, inputs: dict[str, Any]) -> str:
    """The digest that identifies a repeated request; raises ``InvalidInput`` when the inputs are not JSON."""
    try:
        text = canonical([process_id, inputs])
    except (TypeError, ValueError) as error:
        raise InvalidInput(f"inputs: required a JSON object, received {error}", field="inputs") from None
    return sha256(text.encode()).hexdigest()


def _own_key(submitter: str, key: str | None) -> str | None:
    """The stored form of the key: equal keys of two submitters stay different."""
    return key if key is None or not submitter else sha256(f"{submitter} {key}".encode()).hexdigest()


def _by_key(session: Session, key: str | None) -> JobRow | None:
    if key is None:
        return None
    return session.scalar(select(JobRow).where(JobRow.idempotency_key == key))


def _same(first: JobRow, request: str) -> Job:
    if first.request_sha256 != request:
        raise IdempotencyMismatch(
            f"this Idempotency-Key belongs to job {first.id}, which was another request; required the same "
            "process and inputs, or a new key",
            field="Idempotency-Key",
            required="the same request body, or a new key",
        )
    return first.record()


def _repeated(job: JobRow, request: str) -> Job:
    if job.request_sha256 != request:
        raise Conflict(
            f"job {job.id} is another request; required the same process and inputs, or a new id",
            field="jobID",
            required="the same process and inputs, or a new id",
            received=job.id,
        )
    return job.record()


def _require_room(session: Session, most: int) -> None:
    waiting = session.scalar(select(func.count()).where(JobRow.status == JobStatus.ACCEPTED.value)) or 0
    if waiting >= most:
        raise QueueFull(
            f"{waiting} jobs wait already; required fewer than {most}",
            required=f"fewer than {most} waiting jobs",
            received=waiting,
        )
