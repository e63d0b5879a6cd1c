"""Models of the documents about callers, keys and the audit log, which the OpenAPI description shows."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from pydantic import BaseModel, Field

from safestart.model.wire_model import WireModel
from safestart.runtime.access import Role


class CallerDocument(BaseModel):
    """Who is asking."""

    key_id: str | None = Field(description="Id of the key; null where no keys are in use.")
    name: str = Field(description="Name of the key; local without one.")
    role: Role = Field(description="What the caller may do: read; submit; admin.")


class KeyDocument(BaseModel):
    """An API key without its secret."""

    id: str = Field(description="Public part of the key: it names the key in lists and logs.")
    name: str
    role: Role
    created: datetime
    expires: datetime | None
    revoked: datetime | None
    last_used: datetime | None = Field(description="Updated about once a minute.")
    usable: bool = Field(description="Neither revoked nor expired.")


class KeyRequest(WireModel):
    """A key to make."""

    name: str = Field(
        min_length=1, max_length=100, description="Who or what uses it.", examples=["ground segment"]
    )
    role: Role = Field(Role.READ, description="read; submit, which includes read; admin, which includes all.")
    days: float | None = Field(90.0, gt=0, le=3660, description="Days until it expires; null: never.")


class NewKeyDocument(KeyDocument):
    """A key that was just made."""

    key: str = Field(description="The key itself; it cannot be shown again.")


class KeyList(BaseModel):
    """All keys."""

    keys: list[KeyDocument]


class AuditDocument(BaseModel):
    """Who did what to which job or key, and when."""

    id: int
    at: datetime
    action: str
    subject: str = Field(description="Id of a job or a key.")
    key_id: str | None = Field(description="Null without a key.")
    actor: str = Field(description="The key's name; local or cli without one.")
    address: str | None
    request_id: str | None
    detail: dict[str, Any] | None


class AuditList(BaseModel):
    """A page of the audit log, newest first."""

    entries: list[AuditDocument]
    next_before: int | None
