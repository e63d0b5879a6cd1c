"""Every error as an RFC 9457 problem document, built in one place and mapped by one set of handlers."""

from __future__ import annotations

import json
import logging
import math
from http import HTTPStatus
from typing import Any

import orjson
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict, Field
from starlette._utils import get_route_path
from starlette.exceptions import HTTPException

from safestart.errors import SafestartError, Unavailable
from safestart.model.validation import refusal
from safestart.runtime.logs import about
from safestart_service.pages import render as pages

MEDIA_TYPE = "application/problem+json"
OGC_PREFIX = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"
OWN_PREFIX = "urn:safestart:problem:"
OGC_SLUGS = frozenset({"no-such-process", "no-such-job", "result-not-ready"})
MAX_SHOWN = 200
CHALLENGE = 'Bearer realm="safestart"'

log = logging.getLogger("safestart.service")


class Problem(BaseModel):
    """RFC 9457 problem document; ``field``, ``required`` and ``received`` are our additions."""

    model_config = ConfigDict(extra="allow")

    type: str = Field(description="Identifies the kind of problem.", examples=[OWN_PREFIX + "invalid-input"])
    title: str = Field(description="The kind of problem in words.")
    status: int = Field(description="HTTP status.")
    detail: str = Field(description="What went wrong this time.")
    instance: str = Field(description="Path of the request.")
    field: str | None = Field(description="The wrong input, if any.")
    required: str | None = Field(description="What was required of it.")
    received: Any = Field(description="What came.")
    request_id: str | None = Field(None, description="The X-Request-ID of the answer.")


def type_uri(slug: str) -> str:
    """Problem type of a slug; the type of OGC API - Processes 1.0 if it defines one."""
    return (OGC_PREFIX if slug in OGC_SLUGS else OWN_PREFIX) + slug


def _shown(value: Any) -> Any:
    """A value fit for JSON: scalars as they are, everything else as text; nothing longer than a line or two."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int) and abs(value) < 2**53:
        return value
    if isinstance(value, float) and math.isfinite(value):
        return value
    try:
        text = value if isinstance(value, str) else repr(value)
    except ValueError:  # an integer too long for Python to print
        text = f"an integer of {value.bit_length()} bits" if isinstance(value, int) else type(value).__name__
    return text if len(text) <= MAX_SHOWN else text[: MAX_SHOWN - 3] + "..."


def document(
    slug: str,
    title: str,
    status: int,
    detail: str,
    instance: str,
    *,
    field: str | None = None,
    required: str | None = None,
    received: Any = None,
    request_id: str | None = None,
) -> dict[str, Any]:
    """Members of a problem document."""
    return {
        "type": type_uri(slug),
        "title": title,
        "status": status,
        "detail": detail,
        "instance": instance,
        "field": field,
        "required": required,
        "received": _shown(received),
        "request_id": request_id,
    }


def encode(problem: dict[str, Any]) -> bytes:
    """JSON of a problem; text that is not valid Unicode is escaped rather than refused."""
    try:
        return orjson.dumps(problem)
    except TypeError:
        return json.dumps(problem).encode("ascii")


def of_error(error: SafestartError, instance: str, request_id: str | None = None) -> dict[str, Any]:
    """Problem document of one of our exceptions. Where the database is says the log alone."""
    if error.field == "database_url":
        log.warning("%s: %s", instance, error.detail, extra=about(request=request_id) if request_id else None)
        error = Unavailable(
            "the database does not answer; the service's log says why", required="a database that answers"
        )
    return document(
        error.slug,
        error.title,
        error.status,
        error.detail,
        instance,
        field=error.field,
        required=error.required,
        received=error.received,
        request_id=request_id,
    )


def unexpected(instance: str, request_id: str | None) -> dict[str, Any]:
    """Problem document of an unexpected error; reveals no internals."""
    return document(
        "internal",
        "Internal error",
        500,
        "an unexpected error; the service's log has it under the request id",
        instance,
        request_id=request_id,
    )


def headers_of(error: SafestartError) -> dict[str, str]:
    """Header fields that belong to an error's status."""
    if error.status == 401:
        return {"WWW-Authenticate": CHALLENGE}
    if error.status in (408, 413, 501):  # the rest of the body stays unread
        return {"Connection": "close"}
    if error.status in (429, 503):
        return {"Retry-After": "1" if error.slug == "rate-limited" else "5"}
    return {}


def _respond(problem: dict[str, Any], headers: dict[str, str] | None = None) -> Response:
    return Response(encode(problem), problem["status"], headers, media_type=MEDIA_TYPE)


def _request_id(request: Request) -> str | None:
    return request.scope.get("safestart.request_id")


async def _on_own(request: Request, error: Exception) -> Response:
    assert isinstance(error, SafestartError)
    return _respond(of_error(error, request.scope["path"], _request_id(request)), headers_of(error))


def _methods_at(request: Request) -> str:
    """Methods allowed at this path: those of every route with this path, HEAD and OPTIONS."""
    methods: set[str] = set()
    for pattern, answered in request.app.state.route_table:
        if pattern.fullmatch(get_route_path(request.scope)):
            methods |= answered
    if "GET" in methods and not request.scope["path"].endswith("/events"):
        methods.add("HEAD")
    return ", ".join(sorted({*methods, "OPTIONS"}))


async def _on_http(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    status = HTTPStatus(error.status_code)
    slug = status.phrase.lower().replace(" ", "-")
    detail = str(error.detail)
    required = received = None
    headers = dict(error.headers or {})
    root = request.scope.get("root_path", "")
    if status is HTTPStatus.NOT_FOUND and pages.wanted(request):
        return pages.missing(request, root)
    if status is HTTPStatus.NOT_FOUND and detail == status.phrase:
        detail = f"nothing is at {request.scope['path']}; {root}/openapi.json lists all paths"
    elif status is HTTPStatus.METHOD_NOT_ALLOWED:
        headers["Allow"] = required = _methods_at(request)
        if request.method == "OPTIONS":
            return Response(status_code=204, headers={"Allow": required})
        received = request.method
        detail = f"{request.scope['path']} does not answer {received}; it answers {required}"
    problem = document(
        slug,
        status.phrase,
        status.value,
        detail,
        request.scope["path"],
        required=required,
        received=received,
        request_id=_request_id(request),
    )
    return _respond(problem, headers)


async def _on_validation(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    reports = [{**item, "loc": item["loc"][1:] or item["loc"]} for item in error.errors()]
    return await _on_own(request, refusal(reports))


def install(app: FastAPI) -> None:
    """Register the handlers; :mod:`safestart_service.http.limits` answers all other errors with a 500."""
    app.add_exception_handler(SafestartError, _on_own)
    app.add_exception_handler(HTTPException, _on_http)
    app.add_exception_handler(RequestValidationError, _on_validation)
