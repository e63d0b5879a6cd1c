"""The tables. Rows stay inside the store, which hands out frozen records."""

from __future__ import annotations

from dataclasses import fields
from datetime import datetime
from typing import Any

from sqlalchemy import (
    JSON,
    BigInteger,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    String,
    Table,
    Text,
)
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

from safestart.store.dialect import UtcTime
from safestart.store.records import Event, Job, JobStatus, Shard

# SQLite counts only in a column of exactly this type; its integers have 64 bits anyway.
Counter = BigInteger().with_variant(Integer(), "sqlite")


class Base(DeclarativeBase):
    """Base of the tables; constraints get names, so that migrations can refer to them."""

    metadata = MetaData(
        naming_convention={
            "ix": "ix_%(table_name)s_%(column_0_N_name)s",
            "uq": "uq_%(table_name)s_%(column_0_N_name)s",
            "fk": "fk_%(table_name)s_%(column_0_N_name)s",
            "pk": "pk_%(table_name)s",
        }
    )
    type_annotation_map = {  # noqa: RUF012 (SQLAlchemy reads it as declared)
        datetime: UtcTime(),
        # none_as_null: an absent document is SQL NULL, not the JSON word null.
        dict[str, Any]: JSON(none_as_null=True),
    }


def table(row: type[Base]) -> Table:
    """The table of a row class: statements on it skip the object mapper, which costs more than the statements."""
    found = row.__table__
    assert isinstance(found, Table)
    return found


class JobRow(Base):
    """One job.

    ``seq`` is the order of submission; ``token`` grows with every change of hands (fencing); ``submitter`` names
    the submitter ("" when the service requires no keys) and ``turn`` is its round among the submitters (see
    ``fairness``). ``search`` is the text that a search looks through (see ``labelling``), ``verdict`` the word of the
    ``outcome``.
    """

    __tablename__ = "jobs"

    seq: Mapped[int] = mapped_column(Counter, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(36), unique=True)
    process_id: Mapped[str] = mapped_column(String(100))
    status: Mapped[str] = mapped_column(String(16))
    priority: Mapped[int] = mapped_column(default=0)
    inputs: Mapped[dict[str, Any]]
    instant: Mapped[dict[str, Any] | None]
    idempotency_key: Mapped[str | None] = mapped_column(String(255), unique=True)
    request_sha256: Mapped[str] = mapped_column(String(64))
    progress: Mapped[float] = mapped_column(default=0.0)
    message: Mapped[str] = mapped_column(Text, default="")
    eta_s: Mapped[float | None]
    attempts: Mapped[int] = mapped_column(default=0)
    cancel_requested: Mapped[bool] = mapped_column(default=False)
    timeout_s: Mapped[float]
    submitter: Mapped[str] = mapped_column(String(64), default="", server_default="")
    turn: Mapped[int] = mapped_column(Counter, default=0, server_default="0")
    owner: Mapped[str | None] = mapped_column(String(255))
    token: Mapped[int] = mapped_column(default=0)
    lease_expires_at: Mapped[datetime | None]
    lease_s: Mapped[float | None]
    created_at: Mapped[datetime]
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]
    updated_at: Mapped[datetime]
    problem: Mapped[dict[str, Any] | None]
    versions: Mapped[dict[str, Any] | None]
    name: Mapped[str] = mapped_column(String(100), default="", server_default="")
    tags: Mapped[list[str]] = mapped_column(JSON, default=list, server_default="[]")
    note: Mapped[str] = mapped_column(Text, default="", server_default="")
    search: Mapped[str] = mapped_column(Text, default="", server_default="")
    verdict: Mapped[str | None] = mapped_column(String(64))
    outcome: Mapped[dict[str, Any] | None]

    __table_args__ = (
        # The queue in serving order, and the few running rows.
        Index("ix_jobs_queue", "status", "priority", "turn", "seq", "process_id"),
        Index("ix_jobs_submitter", "submitter", "status", "priority", "turn"),
        Index("ix_jobs_ended", "status", "finished_at"),
        # The list by status, and the counts.
        Index("ix_jobs_status_seq", "status", "seq"),
        Index("ix_jobs_process_seq", "process_id", "seq"),
        Index("ix_jobs_verdict_seq", "verdict", "seq"),
        # A search reads all texts: these, not the rows with their inputs.
        Index("ix_jobs_search_seq", "search", "seq"),
        {"sqlite_autoincrement": True},
    )

    def record(self) -> Job:
        """The frozen record of this row."""
        values = {field.name: getattr(self, field.name) for field in fields(Job)}
        return Job(**values | {"status": JobStatus(self.status)})


class ResultRow(Base):
    """The result document of a successful job."""

    __tablename__ = "results"

    job_id: Mapped[str] = mapped_column(ForeignKey("jobs.id"), primary_key=True)
    schema_version: Mapped[int]
    document: Mapped[dict[str, Any]]
    sha256: Mapped[str] = mapped_column(String(64))
    created_at: Mapped[datetime]


class ArtifactRow(Base):
    """A file of a result with its bytes: one database is the whole record."""

    __tablename__ = "artifacts"

    job_id: Mapped[str] = mapped_column(ForeignKey("jobs.id"), primary_key=True)
    name: Mapped[str] = mapped_column(String(255), primary_key=True)
    media_type: Mapped[str] = mapped_column(String(255))
    size: Mapped[int]
    sha256: Mapped[str] = mapped_column(String(64))
    data: Mapped[bytes] = mapped_column(LargeBinary)


class ShardRow(Base):
    """A finished shard of a running job: a worker that takes the job over does not compute it again."""

    __tablename__ = "shards"

    job_id: Mapped[str] = mapped_column(ForeignKey("jobs.id"), primary_key=True)
    number: Mapped[int] = mapped_column(primary_key=True)
    content: Mapped[str] = mapped_column(String(64))
    document: Mapped[dict[str, Any]]
    data: Mapped[bytes] = mapped_column(LargeBinary)
    created_at: Mapped[datetime]

    def record(self) -> Shard:
        """The frozen record of this row."""
        return Shard(number=self.number, content=self.content, document=self.document, data=self.data)


class EventRow(Base):
    """One thing that happened to a job.

    The transaction that updates a job's row also adds its events, and that row's lock orders them: a reader who
    asks for ids after the last one seen misses none.
    """

    __tablename__ = "events"

    id: Mapped[int] = mapped_column(Counter, primary_key=True, autoincrement=True)
    job_id: Mapped[str] = mapped_column(ForeignKey("jobs.id"))
    at: Mapped[datetime]
    kind: Mapped[str] = mapped_column(String(16))
    data: Mapped[dict[str, Any]]

    __table_args__ = (Index("ix_events_job_id_id", "job_id", "id"), {"sqlite_autoincrement": True})

    def record(self) -> Event:
        """The frozen record of this row."""
        return Event(id=self.id, job_id=self.job_id, at=self.at, kind=self.kind, data=self.data)


class WorkerRow(Base):
    """A worker and its last heartbeat; lets the service say why a job waits."""

    __tablename__ = "workers"

    owner: Mapped[str] = mapped_column(String(255), primary_key=True)
    capacity: Mapped[int]
    busy: Mapped[int]
    heartbeat_at: Mapped[datetime]


class CacheRow(Base):
    """Cached data by content key; nothing refers to this table, so it may be emptied at any time."""

    __tablename__ = "cache"

    seq: Mapped[int] = mapped_column(Counter, primary_key=True, autoincrement=True)
    key: Mapped[str] = mapped_column(String(64), unique=True)
    sha256: Mapped[str] = mapped_column(String(64))
    size: Mapped[int]
    data: Mapped[bytes] = mapped_column(LargeBinary)

    __table_args__ = {"sqlite_autoincrement": True}  # noqa: RUF012 (SQLAlchemy reads it as declared)


class TallyRow(Base):
    """A counter of a rare event."""

    __tablename__ = "tally"

    name: Mapped[str] = mapped_column(String(64), primary_key=True)
    number: Mapped[int] = mapped_column(BigInteger, default=0)
