"""A route whose whole input is one query, without FastAPI's dependency machinery.

FastAPI documents its model as usual, but resolving the parameters one by one would take longer than a closed-form
answer. This route splits the query string once and validates it in one call.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Container
from typing import Any, TypeVar
from urllib.parse import parse_qsl

from fastapi import Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from starlette.types import Receive, Scope, Send

from safestart.errors import invalid
from safestart.model.plain_numbers import GROUPED, require_plain
from safestart_service.http.answers import send_json

Query = TypeVar("Query")


def query_values(raw: bytes, numbers: Container[str] = ()) -> dict[str, str]:
    """Parameters of a query string.

    Raises ``InvalidInput`` for a repeated parameter, which is ambiguous, for ``1_0``, which pydantic reads as 10 but is
    more likely a slip for 1.0, and for ``numbers`` that are not written as such.
    """
    text = raw.decode("latin-1")
    if "%" in text or "+" in text:
        pairs = parse_qsl(text, keep_blank_values=True)
        text = "&".join(value for _, value in pairs)
        for name, value in pairs:  # only escapes can make a plus sign or a space
            if name in numbers:
                require_plain(name, value)
    else:  # nothing to unescape, the usual case
        pairs = [part.partition("=")[::2] for part in text.split("&") if part]
    values = dict(pairs)
    if len(values) != len(pairs):
        seen: set[str] = set()
        for name, value in pairs:
            if name in seen:
                raise invalid(name, "one value", f"another one, {value}")
            seen.add(name)
    if GROUPED.search(text):
        for name, value in pairs:
            if GROUPED.search(value):
                require_plain(name, value)
    return values


def query_route(
    parse: Callable[[dict[str, str]], Query],
    answer: Callable[[Request, Query], Awaitable[Response]],
    instant: Callable[[Query, Scope], Any] = lambda _, __: None,
    numbers: Container[str] = (),
) -> type[APIRoute]:
    """An ``APIRoute`` class that serves ``answer(request, parse(parameters))``; the endpoint is only documentation.

    ``instant`` gives the document of a query that takes microseconds, sent at once, or None. Its second argument is
    the request's scope. ``numbers`` are the parameters that are numbers.
    """

    class QueryRoute(APIRoute):
        """Route class for one query."""

        async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
            """Serve one request."""
            if scope["method"] != "GET":
                await super().handle(scope, receive, send)  # refuses it
                return
            query = parse(query_values(scope["query_string"], numbers))
            document = instant(query, scope)
            if document is None:
                response = await answer(Request(scope, receive, send), query)
                await response(scope, receive, send)
            else:
                await send_json(send, document)

    return QueryRoute
