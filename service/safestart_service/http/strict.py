"""Queries are read strictly, on every call: known names only, one value where one counts, plain numbers.

Otherwise a misspelt parameter or the first of two values would silently not count, and ``1_0`` would be 10.
"""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Iterator
from typing import Any, get_origin
from urllib.parse import parse_qsl, urlencode

from fastapi import Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from pydantic import BaseModel

from safestart.errors import invalid
from safestart.model.plain_numbers import is_number, require_plain

FORM = "f"
"""Clients of OGC APIs ask for JSON with it; that is what they get in any case."""


def require_form(value: str) -> None:
    """Raise ``InvalidInput`` for another form of an answer than JSON."""
    if value != "json":
        raise invalid(FORM, "json", value)


class StrictRoute(APIRoute):
    """A route that checks its query before anything reads it."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """The usual handler, after that check."""
        handle = super().get_route_handler()
        known = dict(_parameters(self))

        async def strict(request: Request) -> Response:
            if request.scope["query_string"]:
                _check(request, known)
            return await handle(request)

        return strict


def _check(request: Request, known: dict[str, Any]) -> None:
    pairs = parse_qsl(request.scope["query_string"].decode("latin-1"), keep_blank_values=True)
    seen: set[str] = set()
    for name, value in pairs:
        kind = known.get(name, str)
        if name in seen and get_origin(kind) is not list:
            raise invalid(name, "one value", f"another one, {value}")
        seen.add(name)
        if name == FORM and name not in known:
            require_form(value)
        elif name not in known:
            raise invalid(name, "no field of this name", value)
        elif is_number(kind):
            require_plain(name, value)
    if FORM in seen and FORM not in known:
        kept = [pair for pair in pairs if pair[0] != FORM]
        request.scope["query_string"] = urlencode(kept).encode("ascii")


def _parameters(route: APIRoute) -> Iterator[tuple[str, Any]]:
    """Names and types of the query parameters."""
    for parameter in route.dependant.query_params:
        model = parameter.field_info.annotation
        if isinstance(model, type) and issubclass(model, BaseModel):
            for name, field in model.model_fields.items():
                yield field.alias or name, field.annotation
        else:
            yield parameter.alias, model
