"""Offers of another protocol are passed over: the request is answered in HTTP/1.1 (RFC 9110, section 7.8).

Every Java client offers HTTP/2 with each request (``Upgrade: h2c``). httptools takes each offer for accepted: it drops
the request's body and parses nothing more on the connection.

CONNECT offers to leave HTTP for good: what follows it is meant for a tunnel. It is answered like any other method that
no path has, and nothing behind it is taken for a request.
"""

from __future__ import annotations

import httptools
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

_FRAMING = (b"content-length", b"transfer-encoding")


class Offers(HttpToolsProtocol):
    """A connection that goes on in HTTP/1.1 whatever is offered."""

    _tunnel = False

    def data_received(self, data: bytes) -> None:
        """Parse; after a head with an offer, another parser reads what follows."""
        self._unset_keepalive_if_required()
        try:
            while data and not self._tunnel:
                data = self._behind_offer(data)
        except (httptools.HttpParserError, httptools.HttpParserUpgrade):
            self.send_400_response("")

    def on_headers_complete(self) -> None:
        """The head is whole. The target of a CONNECT names no path, but an address that nobody here goes to."""
        self._tunnel = self.parser.get_method() == b"CONNECT"
        if self._tunnel:
            self.url = b"/"
        super().on_headers_complete()
        if self._tunnel:
            self.cycle.keep_alive = False

    def on_message_complete(self) -> None:
        """The request is complete, unless httptools says so only because of an offer."""
        if self._is_whole():
            super().on_message_complete()

    def _is_whole(self) -> bool:
        return self._tunnel or not self.parser.should_upgrade()

    def _behind_offer(self, data: bytes) -> bytes:
        """Parse up to the end of the next head with an offer; the rest."""
        try:
            self.parser.feed_data(data)
            return b""
        except httptools.HttpParserUpgrade as offer:
            rest: bytes = data[offer.args[0] :]
        if not self._tunnel:
            self._go_on()
        return rest

    def _go_on(self) -> None:
        """Take a new parser, and tell it what the head said about the length of the body."""
        framing = [name + b": " + value for name, value in self.scope["headers"] if name in _FRAMING]
        version = self.scope["http_version"].encode()
        method = self.scope["method"].encode()
        head = [method + b" / HTTP/" + version, *framing, b"", b""]
        self.parser = httptools.HttpRequestParser(_Rest(self))
        self.parser.set_dangerous_leniencies(lenient_data_after_close=True)
        self.parser.feed_data(b"\r\n".join(head))


class _Rest:
    """What a parser says to a connection, without the first head: the connection has seen it."""

    def __init__(self, connection: HttpToolsProtocol) -> None:
        self._connection = connection
        self._seen = True

    def on_message_begin(self) -> None:
        if not self._seen:
            self._connection.on_message_begin()

    def on_url(self, url: bytes) -> None:
        if not self._seen:
            self._connection.on_url(url)

    def on_header(self, name: bytes, value: bytes) -> None:
        if not self._seen:
            self._connection.on_header(name, value)

    def on_headers_complete(self) -> None:
        if not self._seen:
            self._connection.on_headers_complete()
        self._seen = False

    def on_body(self, body: bytes) -> None:
        self._connection.on_body(body)

    def on_message_complete(self) -> None:
        self._connection.on_message_complete()
