"""Move whole jobs in and out of the store, in the form of bundles."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import insert, select
from sqlalchemy.orm import Session

from safestart.errors import Conflict, InvalidInput
from safestart.records.artifact import Artifact
from safestart.records.bundle import Bundle
from safestart.records.bundle_parts import event_facts, job_facts
from safestart.records.comparable import digest
from safestart.store.database import Database
from safestart.store.jobs.finding import find
from safestart.store.jobs.labelling import searched
from safestart.store.jobs.results import require_unaltered
from safestart.store.jobs.submissions import request_hash
from safestart.store.jobs.writing import add_result
from safestart.store.models import ArtifactRow, EventRow, JobRow, ResultRow
from safestart.store.records import JobStatus

_TIMES = ("created_at", "started_at", "finished_at", "updated_at")
_FACTS = (
    *("id", "process_id", "status", "inputs", "instant", "attempts", "timeout_s", "priority"),
    *("message", "problem", "versions"),
)
_LABELS = ("name", "tags", "note")


class Transfer:
    """Reads an ended job with everything that belongs to it; adds a job from elsewhere."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def read(self, job_id: str) -> Bundle:
        """Read all that is kept of an ended job; raises ``NotFound``, and ``Conflict`` before its end.

        It raises ``Altered`` when the stored result was altered, so that no altered result leaves the store.
        The names of the submitter and the worker are not exported.
        """
        with self._database.session() as session:
            row = find(session, job_id)
            if not JobStatus(row.status).ended:
                raise Conflict(
                    f"job {job_id} is {row.status}; required a job that has ended",
                    field="jobID",
                    required="a job that has ended",
                    received=row.status,
                )
            job = {name: getattr(row, name) for name in _FACTS}
            job |= {name: _iso(getattr(row, name)) for name in _TIMES}
            # Only what there is: a job without labels packs as it did before there were any.
            job |= {name: getattr(row, name) for name in _LABELS if getattr(row, name)}
            stored = session.get(ResultRow, job_id)
            events = session.scalars(select(EventRow).where(EventRow.job_id == job_id).order_by(EventRow.id))
            files = session.scalars(
                select(ArtifactRow).where(ArtifactRow.job_id == job_id).order_by(ArtifactRow.name)
            ).all()
            require_unaltered(job_id, stored, files)
            return Bundle(
                job,
                None if stored is None else stored.document,
                [{"at": event.at.isoformat(), "kind": event.kind, "data": event.data} for event in events],
                tuple(Artifact(file.name, file.media_type, bytes(file.data)) for file in files),
            )

    def add(self, bundle: Bundle, outcome: dict[str, Any] | None = None) -> bool:
        """Add the job under its own id; False when the store already has it with the same content.

        ``outcome`` is the verdict of its result; a bundle does not say one, as it could say another than its result.
        Raises ``Conflict`` when another job or result has its id, and ``InvalidInput`` for malformed facts.
        """
        values, events = _values(bundle.job), event_facts(bundle.events)
        status = JobStatus(values["status"])
        if (status is JobStatus.SUCCESSFUL) is (bundle.result is None):
            raise _wrong(f"a {status.value} job {'without' if bundle.result is None else 'with'} a result")
        with self._database.session(write=True) as session:
            if session.scalar(select(JobRow).where(JobRow.id == values["id"])) is not None:
                _require_same(session, bundle)
                return False
            word = None if outcome is None else outcome["word"]
            session.execute(insert(JobRow).values(**values, outcome=outcome, verdict=word))
            if bundle.result is not None:
                add_result(session, values["id"], bundle.result, bundle.artifacts)
            for event in events:
                session.execute(insert(EventRow).values(job_id=values["id"], **event))
            return True


def _values(job: dict[str, Any]) -> dict[str, Any]:
    values = job_facts(job)
    done = 100.0 if values["status"] == JobStatus.SUCCESSFUL.value else 0.0
    return values | {
        "progress": done,
        "cancel_requested": values["status"] == JobStatus.DISMISSED.value,
        "request_sha256": request_hash(values["process_id"], values["inputs"]),
        "search": searched(values["id"], values["process_id"], values["name"], values["tags"]),
    }


def _require_same(session: Session, bundle: Bundle) -> None:
    there = session.get(ResultRow, bundle.job["id"])
    same = (
        there is None
        if bundle.result is None
        else there is not None and there.sha256 == digest(bundle.result)
    )
    if not same:
        raise Conflict(
            f"job {bundle.job['id']} exists already and has another result; nothing was imported",
            field="jobID",
            required="a new job, or the same one",
            received=bundle.job["id"],
        )


def _iso(time: datetime | None) -> str | None:
    return None if time is None else time.isoformat()


def _wrong(what: str) -> InvalidInput:
    return InvalidInput(
        f"bundle: required an ended job, received {what}", field="bundle", required="an ended job"
    )
