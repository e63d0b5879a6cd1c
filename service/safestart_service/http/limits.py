"""The outermost layer, pure ASGI: request id, security headers, access, caps on body and query, the last resorts.

It precedes every answer, the instant ones too, so it does little per request: it encodes headers once, reads them
in one pass, and wraps ``receive`` only when a body is announced.
"""

from __future__ import annotations

import asyncio
import itertools
import logging
import re
import secrets
from collections.abc import Callable

from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from safestart.errors import SafestartError
from safestart.runtime.children.forks import Forkable
from safestart.runtime.logs import about
from safestart_service.access import head
from safestart_service.access.gate import Access, caller_id
from safestart_service.access.proxies import FIELDS, Proxies
from safestart_service.computing.budget import Budget, Share
from safestart_service.computing.unsent import Unsent, full, is_long
from safestart_service.documents import problems
from safestart_service.errors import BodyTooLarge, Busy, QueryTooLong, RequestTimeout
from safestart_service.shortage import shortage

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


class Limits(Forkable):
    """ASGI middleware around the whole application."""

    def __init__(
        self,
        app: ASGIApp,
        max_body_bytes: int,
        access: Access | None = None,
        timeout_s: float = 60.0,
        refused: Callable[[int], None] = lambda _: None,
        max_bodies_bytes: int = 96_000_000,
        proxies: Proxies | None = None,
        answers: Budget | None = None,
    ) -> None:
        self.app = app
        self.proxies = proxies
        self.max_body_bytes = max_body_bytes
        self.access = access
        self.timeout_s = timeout_s
        self.bodies = Budget(max(max_bodies_bytes, max_body_bytes))
        self.answers = answers
        self.refused = refused  # told the status of what no route answers
        self._prefix = b""
        self._numbers = itertools.count(1)
        self.forked()
        self.tell_of_forks()

    def forked(self) -> None:
        """Number requests unlike the parent."""
        self._prefix = secrets.token_hex(4).encode() + b"-"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        if scope["method"] == "HEAD" and not scope["path"].endswith("/events"):
            scope = {**scope, "method": "GET"}  # the server sends only the head of the answer
        headers, unread = head.read(scope)
        request_id = headers.get(b"x-request-id", b"")
        if not _SAFE_ID.fullmatch(request_id):
            request_id = self._prefix + b"%x" % next(self._numbers)
        scope["safestart.request_id"] = request_id.decode("ascii")
        extra = (*SECURITY_HEADERS, (b"x-request-id", request_id))
        started = False
        unsent: Unsent | None = None
        held: Share | None = None

        async def send_with_headers(message: Message) -> None:
            nonlocal started, unsent, held
            if message["type"] == "http.response.start":
                started = True
                own = any(name == b"content-security-policy" for name, _ in message["headers"])
                message["headers"].extend(extra[1:] if own else extra)
                if self.answers is not None and is_long(message["headers"]):
                    held = Share(self.answers, caller_id(scope))
                    unsent = Unsent(held, send, refuse_answer)
            await (unsent or send)(message)

        async def refuse_answer() -> None:
            nonlocal unsent
            refused, unsent = unsent, None
            assert self.answers is not None
            await self._refuse(scope, request_id, full(self.answers), send_with_headers)
            unsent = refused  # what the application still says is dropped

        refusal = unread or self._misplaced(scope, headers) or self._refusal(scope, headers)
        if refusal is not None:
            await self._refuse(scope, request_id, refusal, send_with_headers)
            return
        share = None
        if b"transfer-encoding" in headers or b"content-length" in headers:
            share = Share(self.bodies)
            receive = self._watched(receive, share)
        try:
            await self.app(scope, receive, send_with_headers)
        except ClientDisconnect:
            log.info("the caller left", extra=about(request=request_id.decode()))
        except Exception as error:
            about_it, no_room = about(request=request_id.decode()), shortage(error)
            if started:  # too late for a problem document: the server cuts the connection
                log.exception("%s %s", scope["method"], scope["path"], extra=about_it)
                raise
            if no_room is None:
                log.exception("%s %s", scope["method"], scope["path"], extra=about_it)
                self.refused(500)
                await _answer(send_with_headers, problems.unexpected(scope["path"], request_id.decode()))
            else:  # where it happened says nothing
                log.warning("%s %s: %s", scope["method"], scope["path"], no_room.detail, extra=about_it)
                await self._refuse(scope, request_id, no_room, send_with_headers)
        finally:
            for one in (share, held):
                if one is not None:
                    one.end()

    async def _refuse(self, scope: Scope, request_id: bytes, error: SafestartError, send: Send) -> None:
        self.refused(error.status)
        problem = problems.of_error(error, scope["path"], request_id.decode())
        await _answer(send, problem, problems.headers_of(error))

    def _misplaced(self, scope: Scope, headers: dict[bytes, bytes]) -> SafestartError | None:
        if self.proxies is None or not (self.proxies.root or not FIELDS.isdisjoint(headers)):
            return None
        return self.proxies.place(scope)

    def _refusal(self, scope: Scope, headers: dict[bytes, bytes]) -> SafestartError | None:
        length = headers.get(b"content-length")
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
        if self.access is None:
            return None
        return self.access.refusal(
            scope, (headers.get(b"host"), headers.get(b"authorization"), headers.get(b"x-api-key"))
        )

    def _too_large(self, received: str) -> BodyTooLarge:
        required = f"at most {self.max_body_bytes} bytes"
        return BodyTooLarge(
            f"body: required {required}, received {received[:40]}",
            field="body",
            required=required,
            received=received,
        )

    def _watched(self, receive: Receive, share: Share) -> Receive:
        """Count the bytes received, as a chunked body announces no length; stop at the cap or the deadline."""
        total = 0
        complete = False
        deadline = asyncio.get_running_loop().time() + self.timeout_s

        async def watching() -> Message:
            nonlocal total, complete
            if complete:
                return await receive()
            try:
                async with asyncio.timeout_at(deadline):
                    message = await receive()
            except TimeoutError:
                raise self._too_slow(total) from None
            if message["type"] == "http.request":
                total += len(message.get("body", b""))
                complete = not message.get("more_body", False)
                if total > self.max_body_bytes:
                    raise self._too_large(f"{total} bytes or more")
                if not share.grow(len(message.get("body", b""))):
                    raise self._busy()
            return message

        return watching

    def _busy(self) -> Busy:
        required = f"at most {self.bodies.most} bytes of bodies in flight"
        return Busy(
            f"the requests in flight fill the memory for bodies; required {required}", required=required
        )

    def _too_slow(self, total: int) -> RequestTimeout:
        required = f"the whole body within {self.timeout_s:g} s"
        return RequestTimeout(
            f"body: required {required}, received {total} bytes",
            field="body",
            required=required,
            received=total,
        )


async def _answer(send: Send, problem: dict[str, object], more: dict[str, str] | None = None) -> None:
    body = problems.encode(problem)
    headers = [(b"content-type", problems.MEDIA_TYPE.encode()), (b"content-length", b"%d" % len(body))]
    headers += [(name.lower().encode(), value.encode()) for name, value in (more or {}).items()]
    await send({"type": "http.response.start", "status": problem["status"], "headers": headers})
    await send({"type": "http.response.body", "body": body})
