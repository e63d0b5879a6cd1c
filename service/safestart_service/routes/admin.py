"""Administration: keys and the audit log. Needs a key with role admin, on loopback too."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from safestart.errors import Conflict
from safestart.store.records import ApiKey, AuditEntry
from safestart_service.access.gate import caller
from safestart_service.documents.access_schemas import (
    AuditList,
    KeyDocument,
    KeyList,
    KeyRequest,
    NewKeyDocument,
)
from safestart_service.documents.openapi import answer, json_body, refusals
from safestart_service.http.answers import Json
from safestart_service.http.body import parse_body, read_body
from safestart_service.http.intervals import without_nul
from safestart_service.http.strict import StrictRoute
from safestart_service.state import services

router = APIRouter(tags=["administration"], route_class=StrictRoute)
KeyId = Annotated[str, Path(description="Id of a key: the part after the first underscore.")]
_NO_STORE = {"Cache-Control": "no-store"}


class AuditQuery(BaseModel):
    """Filters and paging of the audit log."""

    model_config = ConfigDict(extra="forbid")

    subject: str | None = Field(None, max_length=64, description="Only about this job or key.")
    key_id: str | None = Field(None, max_length=12, description="Only by this key.")
    before: int | None = Field(
        None, ge=1, le=2**53, description="Where to continue: `next_before` of the last page."
    )
    limit: int = Field(100, ge=1, le=1000, description="Entries per page.")


@router.get(
    "/admin/keys",
    operation_id="getKeys",
    summary="Keys",
    responses={200: answer(KeyList, "All."), **refusals(503)},
)
def keys(request: Request) -> Response:
    """All keys ever made, without their secrets."""
    return Json({"keys": [key_document(key) for key in services(request).keys.list()]}, headers=_NO_STORE)


@router.post(
    "/admin/keys",
    operation_id="createKey",
    summary="Make a key",
    status_code=201,
    openapi_extra=json_body({"key": KeyRequest}, {"key": {"name": "ground segment", "role": "submit"}}),
    responses={
        201: answer(NewKeyDocument, "The key, shown only once."),
        **refusals(400, 413, 415, 422, 503),
    },
)
async def create(request: Request) -> Response:
    """Make a key. The answer holds it; afterwards nobody can read it again."""
    asked = parse_body(KeyRequest, await read_body(request))
    found, by = services(request), caller(request)

    def respond() -> Response:
        record, key = found.keys.create(asked.name, asked.role, asked.days, by)
        found.keyring.load()
        return Json({**key_document(record), "key": key}, 201, headers=_NO_STORE)

    # Without a thread this never begins; asyncio's pool would make the key later, for nobody.
    return await run_in_threadpool(respond)


@router.delete(
    "/admin/keys/{keyID}",
    operation_id="revokeKey",
    summary="Revoke a key",
    responses={200: answer(KeyDocument, "The key, revoked."), **refusals(404, 409, 503)},
)
def revoke(request: Request, keyID: KeyId) -> Response:
    """End a key for good, at once for this service. Repeating it is harmless."""
    found, by = services(request), caller(request)
    if keyID == by.key_id:
        raise Conflict(
            "a key cannot revoke itself; required another key, or `safestart keys revoke` beside the database",
            field="keyID",
            required="another key",
            received=keyID,
        )
    record = found.keys.revoke(without_nul(keyID), by)
    found.keyring.load()
    return Json(key_document(record), headers=_NO_STORE)


@router.get(
    "/admin/audit",
    operation_id="getAuditLog",
    summary="Audit log",
    responses={200: answer(AuditList, "A page of entries."), **refusals(422, 503)},
)
def audit(request: Request, query: Annotated[AuditQuery, Query()]) -> Response:
    """Who submitted and dismissed which job, made and revoked which key; newest first."""
    page = services(request).audit.entries(
        subject=None if query.subject is None else without_nul(query.subject),
        key_id=None if query.key_id is None else without_nul(query.key_id),
        before=query.before,
        limit=query.limit,
    )
    entries = [audit_document(entry) for entry in page.entries]
    return Json({"entries": entries, "next_before": page.next_before}, headers=_NO_STORE)


def key_document(key: ApiKey) -> dict[str, Any]:
    """A key as a document; there is no secret in it."""
    return {
        "id": key.id,
        "name": key.name,
        "role": key.role.value,
        "created": key.created_at,
        "expires": key.expires_at,
        "revoked": key.revoked_at,
        "last_used": key.last_used_at,
        "usable": key.usable,
    }


def audit_document(entry: AuditEntry) -> dict[str, Any]:
    """An entry as a document."""
    return {
        "id": entry.id,
        "at": entry.at,
        "action": entry.action,
        "subject": entry.subject,
        "key_id": entry.key_id,
        "actor": entry.actor,
        "address": entry.address,
        "request_id": entry.request_id,
        "detail": entry.detail,
    }
