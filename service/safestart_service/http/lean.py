"""A route whose whole input is one query, without FastAPI's dependency machinery.

FastAPI documents its model as usual, but resolving the parameters one by one would take longer than a closed-form
answer. This route splits the query string once and validates it in one call.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any, TypeVar
from urllib.parse import parse_qsl

from fastapi import Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from starlette.types import Receive, Scope, Send

from safestart.errors import invalid
from safestart_service.http.answers import send_json
from safestart_service.http.strict import FORM, require_form

Query = TypeVar("Query")


def query_values(raw: bytes) -> dict[str, str]:
    """Parameters of a query string, without the ``f=json`` of OGC clients.

    Raises ``InvalidInput`` for a repeated parameter, which is ambiguous, and for another ``f``. How numbers are written
    is for whoever knows which parameters are some.
    """
    text = raw.decode("latin-1")
    if "%" in text or "+" in text:
        pairs = parse_qsl(text, keep_blank_values=True)
    else:  # nothing to unescape, the usual case
        pairs = [part.partition("=")[::2] for part in text.split("&") if part]
    values = dict(pairs)
    if len(values) != len(pairs):
        seen: set[str] = set()
        for name, value in pairs:
            if name in seen:
                raise invalid(name, "one value", f"another one, {value}")
            seen.add(name)
    if FORM in values:
        require_form(values.pop(FORM))
    return values


def query_route(
    parse: Callable[[dict[str, str]], Query],
    answer: Callable[[Request, Query], Awaitable[Response]],
    instant: Callable[[Query, Scope], Any] = lambda _, __: None,
) -> type[APIRoute]:
    """An ``APIRoute`` class that serves ``answer(request, parse(parameters))``; the endpoint is only documentation.

    ``instant`` gives the document of a query that takes microseconds, sent at once, or None. Its second argument is
    the request's scope.
    """

    class QueryRoute(APIRoute):
        """Route class for one query."""

        async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
            """Serve one request."""
            if scope["method"] != "GET":
                await super().handle(scope, receive, send)  # refuses it
                return
            query = parse(query_values(scope["query_string"]))
            document = instant(query, scope)
            if document is None:
                response = await answer(Request(scope, receive, send), query)
                await response(scope, receive, send)
            else:
                await send_json(send, document)

    return QueryRoute
