"""Documents the service answers with, as models: they are what the OpenAPI description shows."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, Field

from safestart.store.records import JobStatus


class Link(BaseModel):
    """A link of an OGC API document."""

    href: str
    rel: str
    type: str
    title: str


class Landing(BaseModel):
    """The landing page."""

    title: str
    description: str
    links: list[Link]


class Conformance(BaseModel):
    """Conformance classes that the service implements."""

    conformsTo: list[str]


class ProcessSummary(BaseModel):
    """A process in the list."""

    id: str
    title: str
    description: str
    version: str
    keywords: list[str]
    jobControlOptions: list[Literal["sync-execute", "async-execute", "dismiss"]]
    outputTransmission: list[Literal["value", "reference"]]
    links: list[Link]


class ProcessList(BaseModel):
    """All processes."""

    processes: list[ProcessSummary]
    links: list[Link]


class InputDescription(BaseModel):
    """One input: ``minOccurs`` is 0 when there is a default."""

    title: str
    description: str = ""
    minOccurs: int
    maxOccurs: int
    json_schema: dict[str, Any] = Field(alias="schema")


class OutputDescription(BaseModel):
    """One output."""

    title: str
    description: str = ""
    json_schema: dict[str, Any] = Field(alias="schema")


class ProcessDescription(ProcessSummary):
    """A process with JSON schemas of its inputs and outputs."""

    inputs: dict[str, InputDescription]
    outputs: dict[str, OutputDescription]
    example: dict[str, Any] = Field(description="Inputs to start from.")


class StatusInfo(BaseModel):
    """statusInfo of OGC API - Processes 1.0, and what users of queues ask for besides."""

    jobID: str
    processID: str
    type: Literal["process"]
    status: JobStatus
    message: str
    created: datetime
    started: datetime | None
    finished: datetime | None
    updated: datetime
    progress: int = Field(ge=0, le=100)
    position: int | None = Field(description="Place in the queue, 1 = next; null unless the job waits.")
    reason: str | None = Field(description="Why the job waits; null unless it does.")
    eta_s: float | None = Field(description="Estimated seconds left while it runs.")
    attempts: int
    dismissal_requested: bool
    problem: dict[str, Any] | None = Field(description="Problem document of a failed job.")
    links: list[Link]


class JobDetail(StatusInfo):
    """statusInfo of one job, with its inputs."""

    inputs: dict[str, Any]
    instant: dict[str, Any] | None = Field(description="Scalars of the answer given at submission.")


class Submitted(JobDetail):
    """statusInfo of a new job; ``certificate`` is the instant answer of processes that have one."""

    certificate: dict[str, Any] | None = None


class JobList(BaseModel):
    """A page of jobs, newest first."""

    jobs: list[StatusInfo]
    links: list[Link]


class ArtifactLink(BaseModel):
    """An artifact of a result."""

    name: str
    media_type: str
    size: int
    sha256: str
    href: str


class ResultDocument(BaseModel):
    """The stored result of a job; ``outputs`` is the process's output document."""

    jobID: str
    schema_version: int
    sha256: str = Field(description="SHA-256 over the canonical JSON of outputs.")
    inputs: dict[str, Any]
    outputs: dict[str, Any]
    provenance: dict[str, Any]
    artifacts: list[ArtifactLink]


class Health(BaseModel):
    """The process lives."""

    status: Literal["ok"]
    version: str


class Readiness(BaseModel):
    """The database answers."""

    status: Literal["ready"]
    workers_alive: int
    jobs: dict[str, int]
