"""Models of the documents about processes and jobs, which the OpenAPI description shows."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field
from pydantic.json_schema import SkipJsonSchema

from safestart.processes.base import WireModel
from safestart.records.labels import NAME_TEXT, NOTE_TEXT, TAGS_TEXT, Name, Note, Tags
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
    view_kinds: list[str] = Field(
        alias="safestart:view_kinds", description="Kinds of the views of its outputs."
    )


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


class TableDescription(BaseModel):
    """Lists side by side as a table, or maps over two axes."""

    name: str
    columns: list[str]
    axes: list[str]


class ViewDescription(BaseModel):
    """A view of the outputs; what else it has depends on its kind."""

    model_config = ConfigDict(extra="allow")

    kind: str


# A field that may be absent but is never null; its default only marks absence and is not in the schema.
_ABSENT: dict[str, Any] = {"json_schema_extra": lambda schema: schema.pop("default", None)}


class EngineDescription(BaseModel):
    """An engine of the benchmark, as pages show it."""

    name: str = Field(description="Its name in inputs, rows and arrays.")
    title: str
    colour: str = Field(description="#RRGGBB, legible on light and on dark.")
    summary: str


class ProcessDescription(ProcessSummary):
    """A process with JSON schemas of its inputs and outputs."""

    inputs: dict[str, InputDescription]
    outputs: dict[str, OutputDescription]
    example: dict[str, Any] = Field(description="Inputs to start from.")
    tables: list[TableDescription] = Field(
        alias="safestart:tables", description="Tables over plain lists among the outputs."
    )
    views: list[ViewDescription] = Field(
        alias="safestart:views", description="How a page shows the outputs, the most important first."
    )
    engines: list[EngineDescription] | SkipJsonSchema[None] = Field(
        None,
        alias="safestart:engines",
        description="The engines that it compares, in the order of their runs; absent for other processes.",
        **_ABSENT,
    )


class Outcome(BaseModel):
    """The verdict of a result: the worst of its findings."""

    word: str
    sense: Literal["good", "bad", "open"] = Field(description="open: it decides nothing, or without a proof.")
    count: int = Field(description="Findings that are as bad.")
    of: int = Field(description="All findings.")
    basis: str | None = Field(description="What the verdicts rest on if that is no proof.")


class JobLabels(WireModel):
    """Name, tags and note to write on a job; what is absent or null stays as it is."""

    name: Name | None = Field(None, description=NAME_TEXT, examples=["before the burn of the 12th"])
    tags: Tags | None = Field(None, description=TAGS_TEXT, examples=[["envisat", "night shift"]])
    note: Note | None = Field(None, description=NOTE_TEXT)


class StatusInfo(BaseModel):
    """statusInfo of OGC API - Processes 1.0, and what users of queues ask for besides."""

    jobID: str
    processID: str
    type: Literal["process"]
    status: JobStatus
    message: str
    created: datetime
    started: datetime | SkipJsonSchema[None] = Field(None, description="Absent until then.", **_ABSENT)
    finished: datetime | SkipJsonSchema[None] = Field(None, description="Absent until then.", **_ABSENT)
    updated: datetime
    progress: int = Field(ge=0, le=100)
    position: int | None = Field(description="Place in the queue, 1 = next; null unless the job waits.")
    reason: str | None = Field(description="Why the job waits; null unless it does.")
    starts_in_s: float | None = Field(
        description="Estimated seconds until a waiting job starts (one job's status only)."
    )
    eta_s: float | None = Field(description="Estimated seconds until it ends.")
    priority: int = Field(description="Higher is served first.")
    attempts: int
    submitter: str | None = Field(description="Id of the submitting key; null without one.")
    dismissal_requested: bool
    problem: dict[str, Any] | None = Field(description="Problem document of a failed job.")
    name: str = Field(description="What people call the job; may be empty.")
    tags: list[str]
    note: str
    outcome: Outcome | None = Field(
        description="Verdict of the result; null without one, and for results of earlier versions."
    )
    key_inputs: dict[str, str] | None = Field(
        description="The inputs that make it this run, as text by path; null in a list if they are long."
    )
    links: list[Link]


class JobDetail(StatusInfo):
    """statusInfo of one job, with its inputs."""

    inputs: dict[str, Any]
    instant: dict[str, Any] | None = Field(description="Scalars of the answer given at submission.")


class Submitted(JobDetail):
    """statusInfo of a new job; ``certificate`` is the instant answer of processes that have one."""

    certificate: dict[str, Any] | None = None


class JobInputs(BaseModel):
    """What a job computes, of OGC API - Processes Part 4."""

    inputs: dict[str, Any]
    outputs: dict[str, dict[str, Any]] = Field(description="The outputs that a result holds, by id.")


class JobList(BaseModel):
    """A page of jobs, newest first unless sorted otherwise."""

    jobs: list[StatusInfo]
    total: int = Field(description="Jobs on all pages.")
    links: list[Link]


class ShardsDone(BaseModel):
    """Finished parts of a job, of how many."""

    done: int
    total: int


class Partial(BaseModel):
    """What the finished parts of a job say already."""

    jobID: str
    processID: str
    status: JobStatus
    shards: ShardsDone
    outputs: dict[str, Any] | None = Field(
        description="Summary of the finished parts; null before the first."
    )
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
    """The database and a cluster answer."""

    status: Literal["ready"]
    workers_alive: int
    places: int = Field(description="Jobs that the workers can run at once.")
    places_taken: int
    jobs: dict[str, int]
