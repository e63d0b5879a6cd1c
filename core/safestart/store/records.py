"""The frozen records that the store hands out, free of SQLAlchemy. Times are timezone-aware UTC."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Any

from safestart.runtime.access import Role


class JobStatus(StrEnum):
    """Statuses of OGC API - Processes 1.0."""

    ACCEPTED = "accepted"
    RUNNING = "running"
    SUCCESSFUL = "successful"
    FAILED = "failed"
    DISMISSED = "dismissed"

    @property
    def ended(self) -> bool:
        """True when the job has ended."""
        return self not in (JobStatus.ACCEPTED, JobStatus.RUNNING)


@dataclass(frozen=True, slots=True)
class JobEntry:
    """One submitted job as in a list, without its documents.

    ``progress`` is 0..100; ``eta_s`` the estimated seconds left while it runs; ``problem`` a problem document
    (RFC 9457 members) when it failed; ``submitter`` names the submitter, "" when the service requires no keys;
    ``attempts`` counts the starts that neither ended nor were given back; ``outcome`` is the verdict of the result, if
    its process gives one (:func:`safestart.processes.outcome.outcome_of`).
    """

    id: str
    process_id: str
    status: JobStatus
    progress: float
    message: str
    eta_s: float | None
    attempts: int
    cancel_requested: bool
    timeout_s: float
    priority: int
    submitter: str
    owner: str | None
    lease_expires_at: datetime | None
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    updated_at: datetime
    problem: dict[str, Any] | None
    name: str
    tags: list[str]
    note: str
    outcome: dict[str, Any] | None


@dataclass(frozen=True, slots=True)
class Job(JobEntry):
    """One submitted job with its documents.

    ``instant`` is the answer given at submission; ``versions`` the package versions, git revision and machine that
    produced the result.
    """

    inputs: dict[str, Any]
    instant: dict[str, Any] | None
    versions: dict[str, Any] | None


@dataclass(frozen=True, slots=True)
class Claim:
    """A worker's lease on a running job; ``token`` grows with every claim, so the store can refuse a late writer."""

    job_id: str
    owner: str
    token: int
    process_id: str
    inputs: dict[str, Any]
    attempt: int
    timeout_s: float


@dataclass(frozen=True, slots=True)
class Shard:
    """The result of a finished shard; ``content`` identifies what it depends on."""

    number: int
    content: str
    document: dict[str, Any]
    data: bytes


@dataclass(frozen=True, slots=True)
class Wait:
    """A waiting job: its place (1 = next), and the estimated seconds until it starts and until it ends.

    Of the jobs ahead, ``higher`` have a higher priority, and ``turns`` came later but go first because submitters
    take turns.
    """

    position: int
    starts_in_s: float | None
    ends_in_s: float | None
    higher: int = 0
    turns: int = 0


@dataclass(frozen=True, slots=True)
class Crew:
    """The living workers: their number, their places for jobs, and how many of the places are taken."""

    workers: int
    places: int
    busy: int


@dataclass(frozen=True, slots=True)
class Run:
    """Waiting time of a successful job until its first start, and time from there to its end."""

    process_id: str
    wait_s: float
    run_s: float


@dataclass(frozen=True, slots=True)
class Vitals:
    """Jobs by status, workers, age of the oldest waiting job, counters by name, the latest successful runs."""

    jobs: dict[str, int]
    crew: Crew
    oldest_wait_s: float
    tallies: dict[str, int]
    runs: tuple[Run, ...]


@dataclass(frozen=True, slots=True)
class JobPage:
    """One page of jobs, and the cursors of the pages beside it (None: there is none, or the order is another).

    ``inputs`` are those of each job, None for long ones; ``total`` counts the jobs on all pages.
    """

    jobs: tuple[JobEntry, ...]
    next_cursor: str | None
    prev_cursor: str | None = None
    inputs: tuple[dict[str, Any] | None, ...] = ()
    total: int = 0


@dataclass(frozen=True, slots=True)
class StoredResult:
    """The result document of a job with its SHA-256 (:func:`safestart.records.comparable.digest`)."""

    job_id: str
    schema_version: int
    document: dict[str, Any]
    sha256: str
    created_at: datetime


@dataclass(frozen=True, slots=True)
class ArtifactInfo:
    """An artifact without its bytes."""

    name: str
    media_type: str
    size: int
    sha256: str


@dataclass(frozen=True, slots=True)
class Event:
    """One thing that happened to a job: ``kind`` is status, progress or log; ``id`` grows store-wide."""

    id: int
    job_id: str
    at: datetime
    kind: str
    data: dict[str, Any]


@dataclass(frozen=True, slots=True)
class ApiKey:
    """An API key without its secret; ``usable``: neither revoked nor expired when it was read."""

    id: str
    name: str
    role: Role
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
    last_used_at: datetime | None
    usable: bool


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """An audit entry: a caller did ``action`` to ``subject`` (the id of a job or key); ``key_id`` None without a
    key."""

    id: int
    at: datetime
    action: str
    subject: str
    key_id: str | None
    actor: str
    address: str | None
    request_id: str | None
    detail: dict[str, Any] | None


@dataclass(frozen=True, slots=True)
class AuditPage:
    """One page of the audit log, newest first; ``next_before`` leads to the next (None on the last)."""

    entries: tuple[AuditEntry, ...]
    next_before: int | None
