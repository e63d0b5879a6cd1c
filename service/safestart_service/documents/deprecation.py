"""Announce removals in answers: ``Deprecation`` (RFC 9745), ``Sunset`` (RFC 8594), and a link."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import UTC, datetime
from email.utils import format_datetime
from typing import Any
from urllib.parse import parse_qsl

from starlette.types import ASGIApp, Message, Receive, Scope, Send


@dataclass(frozen=True, slots=True)
class Notice:
    """A call, or one of its query parameters, that is deprecated from ``since`` on and may be removed from
    ``until`` on.

    With ``value`` only that value of the parameter is. Times are aware; ``link`` is the address of the page that names
    the replacement, one of ours if it begins with a slash.
    """

    since: datetime
    until: datetime
    link: str
    parameter: str | None = None
    value: str | None = None

    def __post_init__(self) -> None:
        if self.until <= self.since:
            raise ValueError(f"until: required after {self.since}, received {self.until}")

    def headers(self, root: str = "") -> list[tuple[bytes, bytes]]:
        """Header fields of every affected answer of a service below the path ``root``."""
        sunset = format_datetime(self.until.astimezone(UTC), usegmt=True)
        link = root + self.link if self.link.startswith("/") else self.link
        return [
            (b"deprecation", b"@%d" % int(self.since.timestamp())),
            (b"sunset", sunset.encode()),
            (b"link", f'<{link}>; rel="deprecation"; type="text/html"'.encode()),
        ]

    def fields(self, root: str = "") -> dict[str, str]:
        """The same by name."""
        return {name.decode(): value.decode() for name, value in self.headers(root)}

    def concerns(self, scope: Scope) -> bool:
        """True when this request uses the deprecated call or parameter."""
        if self.parameter is None:
            return True
        asked = parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True)
        return any(name == self.parameter and self.value in (None, value) for name, value in asked)


RENAMED_METHOD = Notice(
    datetime(2026, 12, 1, tzinfo=UTC),
    datetime(2027, 12, 1, tzinfo=UTC),
    "/docs",
    "method",
    "closed_form",
)
"""go-no-go's method `closed_form` is called `paper`."""

NOTICES: dict[tuple[str, str], Notice] = {
    ("GET", "/go-no-go"): RENAMED_METHOD,
    ("GET", "/go-no-go/proof"): RENAMED_METHOD,
}
"""By method and path as in the API description: ``("GET", "/jobs/{jobID}")``."""


class Deprecation:
    """ASGI middleware that adds the fields; installed only when notices exist."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self.telltales = _telltales()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if self.telltales is not None and not self.telltales.search(scope.get("query_string", b"")):
            await self.app(scope, receive, send)
            return

        async def telling(message: Message) -> None:
            if message["type"] == "http.response.start":
                notice = NOTICES.get((scope["method"], getattr(scope.get("route"), "path", "")))
                if notice is not None and notice.concerns(scope):
                    message["headers"].extend(notice.headers(scope.get("root_path", "")))
            await send(message)

        await self.app(scope, receive, telling if scope["type"] == "http" else send)


def _telltales() -> re.Pattern[bytes] | None:
    """Words of which a query that concerns a notice holds one, percent-encoded or not; None: any may concern one."""
    if any(notice.parameter is None for notice in NOTICES.values()):
        return None
    words = {str(notice.value or notice.parameter).encode() for notice in NOTICES.values()} | {b"%"}
    return re.compile(b"|".join(re.escape(word) for word in sorted(words)))


def mark(document: dict[str, Any]) -> None:
    """Mark them in an OpenAPI description; raises ``KeyError`` for a notice about an unknown call or parameter."""
    for (method, path), notice in NOTICES.items():
        operation = document["paths"][path][method.lower()]
        if notice.value is not None:
            continue  # the parameter stays; its description names the value
        if notice.parameter is None:
            operation["deprecated"] = True
        else:
            {item["name"]: item for item in operation["parameters"]}[notice.parameter]["deprecated"] = True
