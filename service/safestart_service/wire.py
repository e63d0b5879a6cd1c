"""HTTP on the wire: uvicorn's protocol, with our words for what is no request, and limits on a request's head.

:mod:`limits` sees a request once its head has been read. What is no HTTP, or never comes to an end, is met here.
"""

from __future__ import annotations

import logging
import secrets
from asyncio import TimerHandle, Transport
from http import HTTPStatus
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from safestart.errors import SafestartError
from safestart.logs import about
from safestart_service import problems
from safestart_service.errors import HeadTooLarge, MalformedRequest, RequestTimeout
from safestart_service.limits import SECURITY_HEADERS

HEAD_S = 20.0
MAX_HEAD_BYTES = 131_072

log = logging.getLogger("safestart.service")


class Protocol(HttpToolsProtocol):
    """One connection. A head must come within :data:`HEAD_S` of the connection, or of the answer before it."""

    _deadline: TimerHandle | None = None
    _reading = False
    _received = 0

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override]
        """Wait for the first head."""
        super().connection_made(transport)
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no longer."""
        self._wait_no_longer()
        super().connection_lost(exc)

    def on_message_begin(self) -> None:
        """A head begins."""
        super().on_message_begin()
        self._reading, self._received = True, 0

    def on_headers_complete(self) -> None:
        """The head is whole."""
        self._reading = False
        self._wait_no_longer()
        super().on_headers_complete()

    def on_response_complete(self) -> None:
        """Wait for the next head, unless it is there."""
        super().on_response_complete()
        if self.cycle.response_complete:
            self._wait()

    def data_received(self, data: bytes) -> None:
        """Count what comes of a head; the chunk in which it begins is not longer than one read."""
        unfinished = self._reading
        super().data_received(data)
        if unfinished and self._reading:
            self._received += len(data)
            if self._received > MAX_HEAD_BYTES:
                required = f"at most {MAX_HEAD_BYTES} bytes"
                self._refuse(
                    HeadTooLarge(
                        f"request line and headers: required {required}", field="headers", required=required
                    )
                )

    def send_400_response(self, msg: str) -> None:  # noqa: ARG002
        """What is no HTTP; called by uvicorn, whose own words are plain text."""
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
        if not self._reading:  # nothing was asked, so nothing is answered
            self.transport.close()
            return
        required = f"request line and headers within {HEAD_S:g} s"
        self._refuse(RequestTimeout(f"headers: required {required}", field="headers", required=required))

    def _refuse(self, error: SafestartError) -> None:
        """Answer and close; where another answer is due or under way on this connection, only close."""
        if self.transport.is_closing():
            return
        cycle: Any = self.cycle
        if cycle is None or cycle.response_complete or (cycle.more_body and not cycle.response_started):
            request_id = secrets.token_hex(8)
            log.info("refused: %s", error.detail, extra=about(request=request_id))
            body = problems.encode(problems.of_error(error, "", request_id))
            headers = {
                "content-type": problems.MEDIA_TYPE,
                "content-length": str(len(body)),
                "connection": "close",
                "x-request-id": request_id,
            }
            lines = [f"HTTP/1.1 {error.status} {HTTPStatus(error.status).phrase}".encode()]
            lines += [f"{name}: {value}".encode() for name, value in headers.items()]
            lines += [name + b": " + value for name, value in SECURITY_HEADERS]
            self.transport.write(b"\r\n".join([*lines, b"", body]))
        self.transport.close()
