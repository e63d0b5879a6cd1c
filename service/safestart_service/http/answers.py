"""Small response helpers: JSON by orjson, entity tags, links."""

from __future__ import annotations

import re
from hashlib import sha256
from typing import Any

import orjson
from fastapi import Request
from fastapi.responses import Response
from starlette._utils import get_route_path
from starlette.types import Receive, Scope, Send

from safestart_service.access.proxies import HOST
from safestart_service.computing.unsent import send_pieces

_HOST = re.compile(r"[A-Za-z0-9._-]+(:\d{1,5})?|\[[0-9A-Fa-f:.]+\](:\d{1,5})?")


class Json(Response):
    """A JSON answer; NaN and infinity become null."""

    media_type = "application/json"

    def render(self, content: Any) -> bytes:
        """Encode a document."""
        return orjson.dumps(content)


class Shared(Response):
    """An answer whose body is in memory once, for everybody: a connection holds a piece of it."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send it, each piece when the client has taken the one before."""
        del scope, receive
        await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
        await send_pieces(send, bytes(self.body))


async def send_json(send: Send, document: Any) -> None:
    """The bytes that :class:`Json` would send."""
    body = orjson.dumps(document)
    headers = [(b"content-length", b"%d" % len(body)), (b"content-type", b"application/json")]
    await send({"type": "http.response.start", "status": 200, "headers": headers})
    await send({"type": "http.response.body", "body": body})


def base_url(request: Request) -> str:
    """Scheme, host and mount path of this request as its client sees them, without a trailing slash.

    A trusted proxy's word counts for the host; the address of the socket replaces an invalid Host header.
    """
    scope = request.scope
    host = scope.get(HOST) or request.headers.get("host", "")
    if not _HOST.fullmatch(host):
        name, port = scope.get("server") or ("127.0.0.1", None)
        host = f"{name}:{port}" if port else name
    return f"{scope.get('scheme', 'http')}://{host}{scope.get('root_path', '')}"


def root_path(request: Request) -> str:
    """The mount path of this request, without a trailing slash."""
    root: str = request.scope.get("root_path", "")
    return root


def this_url(request: Request) -> str:
    """The requested address, query included."""
    query = request.scope["query_string"].decode("latin-1")
    return f"{base_url(request)}{get_route_path(request.scope)}{'?' if query else ''}{query}"


def tagged(request: Request, content: Any, headers: dict[str, str] | None = None) -> Response:
    """A JSON answer with the entity tag of its bytes; 304 if the caller has them already."""
    answer = Json(content, headers={"Cache-Control": "private, no-cache", **(headers or {})})
    tag = entity_tag(sha256(bytes(answer.body)).hexdigest()[:32])
    answer.headers["ETag"] = tag
    return not_modified(request, tag) or answer


def link(href: str, rel: str, title: str, media_type: str = "application/json") -> dict[str, str]:
    """A link object of OGC API documents."""
    return {"href": href, "rel": rel, "type": media_type, "title": title}


def all_lines(request: Request, name: str) -> str | None:
    """A header field that is a list, which may come in several lines (RFC 9110, 5.3); None without one."""
    lines = request.headers.getlist(name)
    return ", ".join(lines) if lines else None


def entity_tag(sha256: str) -> str:
    """Strong entity tag of content with this digest."""
    return f'"{sha256}"'


def not_modified(request: Request, tag: str) -> Response | None:
    """304 if the caller has this content already (If-None-Match, weak comparison)."""
    known = all_lines(request, "if-none-match")
    if known is None:
        return None
    tags = {part.strip().removeprefix("W/") for part in known.split(",")}
    if tag in tags or "*" in tags:
        return Response(status_code=304, headers={"ETag": tag, "Cache-Control": "private, no-cache"})
    return None
