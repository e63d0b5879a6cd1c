"""Checks of the documents inside a bundle: anyone can alter them and seal the bundle anew."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from typing import Annotated, Any, Literal
from unicodedata import category

from pydantic import (
    AfterValidator,
    AwareDatetime,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
)

from safestart.errors import InvalidInput, UnfitResult, invalid
from safestart.model.validation import error_of, validation_error
from safestart.records.labels import Name, Note, Tags

_NOT_PRINTED = frozenset({"Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp"})


def _storable(value: Any) -> Any:
    """Text that every database accepts: PostgreSQL refuses NUL, and half a surrogate pair is not text."""
    if isinstance(value, str) and ("\0" in value or value != value.encode(errors="replace").decode()):
        raise ValueError("text without NUL and lone surrogates")
    return value


def _json(value: Any) -> Any:
    """A document that the service can serve as JSON: no NaN, no infinity, no number or text that JSON cannot hold."""
    try:
        text = json.dumps(value, ensure_ascii=False, allow_nan=False)
        text.encode()
        json.loads(text, parse_int=_whole)
    except (ValueError, TypeError, RecursionError):
        raise ValueError("JSON without NaN, infinity, lone surrogates and integers beyond 64 bits") from None
    return value


def _whole(digits: str) -> int:
    if len(digits) > 20 or not -(2**63) <= int(digits) < 2**64:
        raise ValueError(digits)
    return int(digits)


def _printing(name: str) -> str:
    if any(category(letter) in _NOT_PRINTED for letter in name):
        raise ValueError("a name without control, format and unassigned characters")
    return name


def _in_utc(time: datetime) -> datetime:
    try:
        time.astimezone(UTC)
    except OverflowError:
        raise ValueError("a time within the years 1 to 9999 in UTC") from None
    return time


_Time = Annotated[AwareDatetime, AfterValidator(_in_utc)]
_Text = Annotated[str, BeforeValidator(_storable)]
_Count = Annotated[int, Field(ge=0, lt=2**31, strict=True)]
_Document = Annotated[dict[str, Any], BeforeValidator(_json)]


class Closed(BaseModel):
    """Refuses unknown fields, which would otherwise be passed on unchecked."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class JobFacts(Closed):
    """``job.json``: the row of an ended job."""

    id: Annotated[str, Field(pattern=r"^[0-9A-Za-z-]{1,36}$")]
    process_id: Annotated[_Text, Field(min_length=1, max_length=100)]
    status: Literal["successful", "failed", "dismissed"]
    inputs: _Document
    instant: _Document | None
    attempts: _Count
    timeout_s: Annotated[float, Field(gt=0, strict=True)]
    priority: Annotated[int, Field(ge=-(2**31), lt=2**31, strict=True)]
    message: _Text
    problem: _Document | None
    versions: _Document | None
    created_at: _Time
    started_at: _Time | None
    finished_at: _Time | None
    updated_at: _Time
    name: Name = ""
    tags: Tags = Field(default_factory=list)
    note: Note = ""


class EventFacts(Closed):
    """One entry of ``events.json``."""

    at: _Time
    kind: Literal["status", "progress", "log"]
    data: _Document


class ProcessFacts(Closed):
    """The process part of a result."""

    id: _Text
    version: _Text


class Origin(BaseModel):
    """The origin of a result, as far as anything reads it: everything else is kept unchanged."""

    packages: dict[str, str] = Field(default_factory=dict)
    python: str | None = None
    source_sha256: str | None = None
    git_revision: str | None = None
    machine: dict[str, Any] = Field(default_factory=dict)
    notes: list[str] = Field(default_factory=list)
    started: str | None = None
    finished: str | None = None


class Provenance(Origin):
    """The origin of a result in a bundle, which also has the hash of every artifact."""

    artifacts: dict[str, str]


class ResultFacts(Closed):
    """``result.json``."""

    schema_version: Literal[1]
    process: ProcessFacts
    inputs: dict[str, Any]
    outputs: dict[str, Any]
    provenance: Provenance


class ArtifactFacts(BaseModel):
    """Name and media type of a file.

    The name must not be a path: unpacking would write to it. It has no control or format characters, because pages,
    header lines and links show it.
    """

    name: Annotated[_Text, AfterValidator(_printing), Field(pattern=r"^[^/\\:]{1,255}$")]
    media_type: Annotated[str, Field(pattern=r"^[\x20-\x7e]{1,255}$")]


def job_facts(job: Any) -> dict[str, Any]:
    """The facts of a job, with parsed times; raises ``InvalidInput``."""
    try:
        return JobFacts.model_validate(job).model_dump()
    except ValidationError as error:
        raise validation_error(error, "bundle.job.") from None


def event_facts(events: Any) -> list[dict[str, Any]]:
    """The events, with parsed times; raises ``InvalidInput`` at the first wrong one: reports on all take memory."""
    found = []
    for event in _whole_list(events):
        try:
            found.append(EventFacts.model_validate(event).model_dump())
        except ValidationError as error:
            raise validation_error(error, f"bundle.events.{len(found)}.") from None
    return found


def _whole_list(events: Any) -> list[Any]:
    if not isinstance(events, list):
        raise invalid("bundle.events", "a list", type(events).__name__)
    return events


def require_result(result: Any) -> None:
    """Raise ``InvalidInput`` for a result that cannot be stored or compared."""
    try:
        ResultFacts.model_validate(_json(result))
    except ValidationError as error:
        raise validation_error(error, "bundle.result.") from None
    except ValueError as error:
        raise invalid("bundle.result", str(error), result) from None


def origin_of(result: Mapping[str, Any]) -> Origin:
    """The origin of a stored result; raises ``UnfitResult`` where it is none, as of a result that somebody altered."""
    try:
        return Origin.model_validate(result.get("provenance"))
    except ValidationError as error:
        raise error_of(UnfitResult, error.errors(include_url=False), "provenance.") from None


def require_names(files: Iterable[tuple[Any, Any]]) -> None:
    """Raise ``InvalidInput`` for artifact names and media types that no process produces."""
    for name, media_type in files:
        try:
            ArtifactFacts(name=name, media_type=media_type)
        except ValidationError as error:
            raise validation_error(error, "bundle.artifacts.") from None
        if name in (".", ".."):
            raise InvalidInput(f"bundle.artifacts.name: required the name of a file, received {name!r}")
