"""The outermost layer, pure ASGI: request id, security headers, caps on body and query, the last-resort 500.

It sits in front of every answer, the instant ones too, so it does no more per request than it must: headers are
encoded once, and ``receive`` is wrapped only when a body is announced.
"""

from __future__ import annotations

import itertools
import logging
import re
import secrets

from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from safestart.errors import SafestartError
from safestart_service import problems
from safestart_service.errors import BodyTooLarge, QueryTooLong

MAX_QUERY_BYTES = 8192
CSP = (
    "default-src 'none'; style-src 'self'; img-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)
SECURITY_HEADERS: tuple[tuple[bytes, bytes], ...] = (
    (b"content-security-policy", CSP.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
)
_SAFE_ID = re.compile(rb"[A-Za-z0-9._-]{1,64}")

log = logging.getLogger("safestart.service")


class Limits:
    """ASGI middleware around the whole application."""

    def __init__(self, app: ASGIApp, max_body_bytes: int) -> None:
        self.app = app
        self.max_body_bytes = max_body_bytes
        self._prefix = secrets.token_hex(4).encode() + b"-"
        self._numbers = itertools.count(1)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        request_id, length, chunked = self._read_headers(scope)
        scope["safestart.request_id"] = request_id.decode("ascii")
        extra = (*SECURITY_HEADERS, (b"x-request-id", request_id))
        started = False

        async def send_with_headers(message: Message) -> None:
            nonlocal started
            if message["type"] == "http.response.start":
                started = True
                message["headers"].extend(extra)
            await send(message)

        refusal = self._refusal(scope, length)
        if refusal is not None:
            await _answer(send_with_headers, problems.of_error(refusal, scope["path"], request_id.decode()))
            return
        if chunked:
            receive = self._counted(receive)
        try:
            await self.app(scope, receive, send_with_headers)
        except ClientDisconnect:
            log.info("request %s: the caller left", request_id.decode())
        except Exception:
            log.exception("request %s: %s %s", request_id.decode(), scope["method"], scope["path"])
            if started:  # too late for a problem document: let the server cut the connection
                raise
            await _answer(send_with_headers, problems.unexpected(scope["path"], request_id.decode()))

    def _read_headers(self, scope: Scope) -> tuple[bytes, bytes | None, bool]:
        """Request id (the caller's if it is harmless), Content-Length, whether the body is chunked."""
        request_id = length = None
        chunked = False
        for name, value in scope["headers"]:
            if name == b"content-length":
                length = value
            elif name == b"transfer-encoding":
                chunked = True
            elif name == b"x-request-id" and _SAFE_ID.fullmatch(value):
                request_id = value
        return request_id or self._prefix + b"%x" % next(self._numbers), length, chunked

    def _refusal(self, scope: Scope, length: bytes | None) -> SafestartError | None:
        if length is not None and (
            not length.isdigit() or len(length) > 15 or int(length) > self.max_body_bytes
        ):
            return self._too_large(length.decode("latin-1"))
        if len(scope["query_string"]) > MAX_QUERY_BYTES:
            return QueryTooLong(
                f"query: required at most {MAX_QUERY_BYTES} bytes, received {len(scope['query_string'])}",
                field="query",
                required=f"at most {MAX_QUERY_BYTES} bytes",
                received=len(scope["query_string"]),
            )
        return None

    def _too_large(self, received: str) -> BodyTooLarge:
        required = f"at most {self.max_body_bytes} bytes"
        return BodyTooLarge(
            f"body: required {required}, received {received[:40]}",
            field="body",
            required=required,
            received=received,
        )

    def _counted(self, receive: Receive) -> Receive:
        """A chunked body announces no length: count what comes, and stop reading beyond the cap."""
        total = 0

        async def counting() -> Message:
            nonlocal total
            message = await receive()
            if message["type"] == "http.request":
                total += len(message.get("body", b""))
                if total > self.max_body_bytes:
                    raise self._too_large(f"{total} bytes or more")
            return message

        return counting


async def _answer(send: Send, problem: dict[str, object]) -> None:
    body = problems.encode(problem)
    headers = [(b"content-type", problems.MEDIA_TYPE.encode()), (b"content-length", b"%d" % len(body))]
    if problem["status"] == 413:
        headers.append((b"connection", b"close"))  # the rest of the body is not read
    await send({"type": "http.response.start", "status": problem["status"], "headers": headers})
    await send({"type": "http.response.body", "body": body})
