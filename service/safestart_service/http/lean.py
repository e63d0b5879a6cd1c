"""A route whose whole input is one query model, without FastAPI's dependency machinery.

FastAPI documents the model as usual, but resolving its parameters one by one costs more than the closed-form answer
itself. Here the query string is split once and pydantic validates it in one call.
"""

from __future__ import annotations

import re
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any
from urllib.parse import parse_qsl

from fastapi import Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from pydantic import BaseModel, ValidationError

from safestart.errors import invalid
from safestart.model.validation import validation_error

_GROUPED = re.compile(r"\d_\d")


def query_values(raw: bytes) -> dict[str, str]:
    """Parameters of a query string.

    Raises ``InvalidInput`` when one comes twice, as it is unclear which counts, and for ``1_0``, which pydantic reads
    as 10: in a thrust it is more likely a slip for 1.0.
    """
    text = raw.decode("latin-1")
    if "%" in text or "+" in text:
        pairs = parse_qsl(text, keep_blank_values=True)
        text = "&".join(value for _, value in pairs)
    else:  # nothing to unescape, which is the usual case
        pairs = [
            (name, value) for name, _, value in (part.partition("=") for part in text.split("&") if part)
        ]
    values = dict(pairs)
    if len(values) != len(pairs):
        seen: set[str] = set()
        for name, value in pairs:
            if name in seen:
                raise invalid(name, "one value", f"another one, {value}")
            seen.add(name)
    if _GROUPED.search(text):
        for name, value in pairs:
            if _GROUPED.search(value):
                raise invalid(name, "a number without _ between its digits", value)
    return values


def query_route(
    model: type[BaseModel], answer: Callable[[Request, Any], Awaitable[Response]]
) -> type[APIRoute]:
    """An ``APIRoute`` class that serves ``answer(request, model)``; the endpoint it decorates is the documentation."""
    validate = model.model_validate_strings

    class QueryRoute(APIRoute):
        """Route class for one query model."""

        def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
            """Handler that replaces dependency resolution."""

            async def handle(request: Request) -> Response:
                try:
                    query = validate(query_values(request.scope["query_string"]))
                except ValidationError as error:
                    raise validation_error(error) from None
                return await answer(request, query)

            return handle

    return QueryRoute
