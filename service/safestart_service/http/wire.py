"""HTTP on the wire: uvicorn's protocol with our messages for invalid requests, and limits on each peer.

:mod:`limits` sees a request after its head. This module handles bytes that are not HTTP, heads that never end,
answers that nobody reads, and too many connections.
"""

from __future__ import annotations

import ipaddress
import logging
import re
import secrets
from asyncio import TimerHandle, Transport
from collections.abc import Callable
from enum import Enum, auto
from http import HTTPStatus
from typing import Any

from uvicorn.protocols.http.flow_control import FlowControl

from safestart.errors import SafestartError
from safestart.runtime.logs import about
from safestart_service.access.nearness import is_local
from safestart_service.documents import problems
from safestart_service.errors import HeadTooLarge, MalformedRequest, RequestTimeout, TooManyConnections
from safestart_service.http.limits import SECURITY_HEADERS
from safestart_service.http.places import Places
from safestart_service.http.unread import Read

HEAD_S = 20.0
MAX_HEAD_BYTES = 131_072
MOST_AHEAD = 100
"""Approximate number of requests parsed ahead on one connection; later bytes wait unparsed for earlier answers."""
_PIECE = 8192
TURNED_AWAY_S = 1.0
MOST_TURNED_AWAY = 64

log = logging.getLogger("safestart.service")


class Message(Enum):
    """The part of a message that the next bytes belong to."""

    BETWEEN = auto()
    HEAD = auto()
    BODY = auto()


class Flow(FlowControl):
    """Reading stays paused while bytes wait unparsed, although every handler asks for more."""

    full = False

    def resume_reading(self) -> None:
        """Read on unless bytes wait."""
        if not self.full:
            super().resume_reading()


class Protocol(Read):
    """One connection. A head must come within :data:`HEAD_S` of the connection, or of the answer before it."""

    _deadline: TimerHandle | None = None
    _message = Message.BETWEEN
    _received = 0
    _seated = False
    _active: Any = None

    def __init__(self, *args: Any, places: Places, refused: Callable[[int], None], **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._places = places
        self._refused = refused
        self._held = b""

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override]
        """Wait for the first head if a place is free; otherwise refuse at the first bytes or after a short time."""
        super().connection_made(transport)
        self.flow: Flow = Flow(transport)
        self._holder = holder(self.client[0] if self.client else "")
        self._seated = self._places.take(self._holder)
        if self._seated:
            self._wait()
        elif len(self.connections) > self._places.taken + MOST_TURNED_AWAY:
            self._turn_away()
        else:  # closing before reading the request would discard our answer
            self._deadline = self.loop.call_later(TURNED_AWAY_S, self._turn_away)

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop the timers and free the place."""
        self._wait_no_longer()
        if self._seated:
            self._seated = False
            self._places.leave(self._holder)
        super().connection_lost(exc)
        self._abandon()

    def on_message_begin(self) -> None:
        """A head begins."""
        super().on_message_begin()
        self._message = Message.HEAD

    def on_headers_complete(self) -> None:
        """The head is whole."""
        self._wait_no_longer()
        if b"#" in self.url:  # uvicorn would answer what stands before it
            raise ValueError("a fragment in the target")
        named = named_host(self.url)
        if named is not None and named not in [
            _plain(value) for name, value in self.headers if name == b"host"
        ]:
            # uvicorn drops the host of the target: as another Host field it is checked, and refused beside one.
            self.headers.append((b"host", named))
        super().on_headers_complete()
        self._message = Message.BODY
        self.headers = []  # drop trailers: they do not belong to the head, which is checked already

    def on_body(self, body: bytes) -> None:
        """A part of the body."""
        self._received = 0
        super().on_body(body)

    def on_message_complete(self) -> None:
        """The request is complete, unless an offer of another protocol only makes it look so."""
        if self._is_whole():
            self._message = Message.BETWEEN
            self._received = 0
        super().on_message_complete()

    def on_response_complete(self) -> None:
        """Parse the held bytes, and wait for the next head unless it is there already."""
        super().on_response_complete()
        if self._held:
            self._read_on()
        if self.cycle.response_complete:
            self._wait()

    def data_received(self, data: bytes) -> None:
        """Parse the data in pieces while not too many requests wait for answers."""
        if not self._seated:
            self._turn_away()
            return
        self._held += data
        self._read_on()

    def _read_on(self) -> None:
        while self._held and len(self.pipeline) < MOST_AHEAD:
            piece, self._held = self._held[:_PIECE], self._held[_PIECE:]
            self._read(piece)
            if self.transport.is_closing():
                return
        self.flow.full = bool(self._held)
        if self._held:
            self.flow.pause_reading()

    def _read(self, data: bytes) -> None:
        """Count the bytes since a message or a piece of its body ended: headers, trailers, chunk extensions."""
        self._received += len(data)
        super().data_received(data)
        if self._received > MAX_HEAD_BYTES:
            required = f"at most {MAX_HEAD_BYTES} bytes"
            self._refuse(
                HeadTooLarge(
                    f"request line and headers: required {required}", field="headers", required=required
                )
            )

    def send_400_response(self, msg: str) -> None:  # noqa: ARG002
        """Answer bytes that are not HTTP; replaces uvicorn's plain-text answer."""
        self._refuse(
            MalformedRequest("the request is not HTTP/1.1 (RFC 9112)", required="HTTP/1.1 or HTTP/1.0")
        )

    def _wait(self) -> None:
        self._wait_no_longer()
        self._deadline = self.loop.call_later(HEAD_S, self._too_slow)

    def _wait_no_longer(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _too_slow(self) -> None:
        if self._message is not Message.HEAD:  # no request came, so no answer is due
            self.transport.close()
            return
        required = f"request line and headers within {HEAD_S:g} s"
        self._refuse(RequestTimeout(f"headers: required {required}", field="headers", required=required))

    def _turn_away(self) -> None:
        required = f"at most {self._places.most} connections at once, {self._places.share} from one address"
        self._refuse(TooManyConnections(f"no place is left; required {required}", required=required))

    def _refuse(self, error: SafestartError) -> None:
        """Answer and close; if another answer is due or being sent on this connection, only close."""
        if self.transport.is_closing():
            return
        self._refused(error.status)
        if self._may_answer():
            request_id = secrets.token_hex(8)
            log.info("refused: %s", error.detail, extra=about(request=request_id))
            self.transport.write(_answer(error, request_id))
        self.transport.close()

    def _start_asgi_task(self, cycle: Any, app: Any) -> None:
        self._active = cycle
        super()._start_asgi_task(cycle, app)

    def _abandon(self) -> None:
        """Tell the current handler that the client has left; uvicorn tells only the latest request."""
        if self._active is not None and not self._active.response_complete:
            self._active.disconnected = True
            self._active.message_event.set()

    def _may_answer(self) -> bool:
        """True when the peer will match our next answer to its latest request."""
        cycle: Any = self.cycle
        if self._message is Message.BODY:
            return not (cycle.response_started or self.pipeline)
        return cycle is None or bool(cycle.response_complete)


def named_host(target: bytes) -> bytes | None:
    """The host in a request's target of the absolute form (http://host/path), None in every other form."""
    scheme, mark, rest = target.partition(b"://")
    if not mark or not scheme.isalpha():
        return None
    return _plain(re.split(rb"[/?#]", rest, maxsplit=1)[0])


def _plain(host: bytes) -> bytes:
    """A host as it is compared: without case, and without the port of plain HTTP."""
    return host.strip().lower().removesuffix(b":80")


def holder(address: str) -> str | None:
    """The peer of a connection: an IPv4 address or IPv6 network; None on this machine, which may be a proxy."""
    if not address or is_local(address):
        return None
    found = ipaddress.ip_address(address.partition("%")[0])
    if isinstance(found, ipaddress.IPv6Address) and found.ipv4_mapped is None:  # a customer has 2^64
        return str(ipaddress.IPv6Network((int(found) >> 64 << 64, 64)))
    return address


def _answer(error: SafestartError, request_id: str) -> bytes:
    body = problems.encode(problems.of_error(error, "", request_id))
    headers = {
        "content-type": problems.MEDIA_TYPE,
        "content-length": str(len(body)),
        "x-request-id": request_id,
        **{name.lower(): value for name, value in problems.headers_of(error).items()},
        "connection": "close",
    }
    lines = [f"HTTP/1.1 {error.status} {HTTPStatus(error.status).phrase}".encode()]
    lines += [f"{name}: {value}".encode() for name, value in headers.items()]
    lines += [name + b": " + value for name, value in SECURITY_HEADERS]
    return b"\r\n".join([*lines, b"", body])
