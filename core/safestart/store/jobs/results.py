"""Results and artifacts of ended jobs."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256

from sqlalchemy import select
from sqlalchemy.orm import Session

from safestart.errors import Altered, JobFailed, NotFound, ResultNotReady
from safestart.records.artifact import Artifact
from safestart.records.comparable import digest
from safestart.store.database import Database
from safestart.store.jobs.finding import find
from safestart.store.models import ArtifactRow, JobRow, ResultRow
from safestart.store.records import ArtifactInfo, JobStatus, StoredResult


class ResultRepository:
    """Reads results and artifacts of ended jobs; all methods raise ``NotFound`` for an unknown job."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def result(self, job_id: str) -> StoredResult:
        """The result document.

        Raises ``ResultNotReady`` while the job waits or runs, ``JobFailed`` with the reason when it failed
        and ``NotFound`` when it was dismissed; ``Altered`` when it is not what was stored.
        """
        with self._database.session() as session:
            _require_success(find(session, job_id))
            row = session.get_one(ResultRow, job_id)
            require_unaltered(job_id, row)
            return StoredResult(row.job_id, row.schema_version, row.document, row.sha256, row.created_at)

    def artifact(self, job_id: str, name: str) -> Artifact:
        """One artifact with its bytes; raises as :meth:`result`, and ``NotFound`` names the existing artifacts."""
        with self._database.session() as session:
            _require_success(find(session, job_id))
            row = session.get(ArtifactRow, (job_id, name))
            if row is None:
                names = [info.name for info in _infos(session, job_id)]
                there_are = ", ".join(names) or "none"
                raise NotFound(
                    f"job {job_id} has no artifact {name!r}; there are: {there_are}",
                    field="name",
                    required=f"one of {there_are}",
                    received=name,
                )
            require_unaltered(job_id, None, (row,))
            return Artifact(row.name, row.media_type, row.data)

    def artifacts(self, job_id: str) -> tuple[ArtifactInfo, ...]:
        """The artifacts of a job by name, without their bytes; empty until it is successful."""
        with self._database.session() as session:
            find(session, job_id)
            return _infos(session, job_id)


def require_unaltered(job_id: str, stored: ResultRow | None, files: Sequence[ArtifactRow] = ()) -> None:
    """Raise ``Altered`` unless a result and its files have the SHA-256 that was stored with them."""
    altered = [] if stored is None or digest(stored.document) == stored.sha256 else ["the result"]
    altered += [
        f"artifact {file.name}" for file in files if sha256(bytes(file.data)).hexdigest() != file.sha256
    ]
    if altered:
        raise Altered(
            f"job {job_id} was altered: {', '.join(altered)} does not have the SHA-256 on record",
            field="jobID",
            required="a result and artifacts with the SHA-256 on record",
            received=", ".join(altered),
        )


def _infos(session: Session, job_id: str) -> tuple[ArtifactInfo, ...]:
    columns = (ArtifactRow.name, ArtifactRow.media_type, ArtifactRow.size, ArtifactRow.sha256)
    query = select(*columns).where(ArtifactRow.job_id == job_id).order_by(ArtifactRow.name)
    return tuple(ArtifactInfo(*row) for row in session.execute(query))


def _require_success(row: JobRow) -> None:
    status = JobStatus(row.status)
    if status is JobStatus.SUCCESSFUL:
        return
    if not status.ended:
        raise ResultNotReady(
            f"job {row.id} is {status.value}; results are there when it is successful",
            field="jobID",
            required="a successful job",
            received=status.value,
        )
    kind: type[NotFound]
    if status is JobStatus.FAILED:
        kind, detail = JobFailed, f"job {row.id} failed: {row.message}"
    else:
        kind, detail = NotFound, f"job {row.id} was dismissed, so it has no results"
    raise kind(detail, field="jobID", required="a successful job", received=status.value)
