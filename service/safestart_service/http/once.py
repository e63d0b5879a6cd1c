"""Query parameters that have one value come once: of two, the last would count, and nobody would be told."""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Iterator
from typing import Any, get_origin

from fastapi import Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from pydantic import BaseModel

from safestart.errors import invalid


class OnceRoute(APIRoute):
    """A route that refuses a second value of every query parameter of its that is no list."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """The usual handler, behind that check."""
        handle = super().get_route_handler()
        single = frozenset(_single(self))

        async def once(request: Request) -> Response:
            if request.scope["query_string"]:
                seen: set[str] = set()
                for name, value in request.query_params.multi_items():
                    if name in seen and name in single:
                        raise invalid(name, "one value", f"another one, {value}")
                    seen.add(name)
            return await handle(request)

        return once


def _single(route: APIRoute) -> Iterator[str]:
    """Names of the query parameters that have one value."""
    for parameter in route.dependant.query_params:
        model = parameter.field_info.annotation
        if isinstance(model, type) and issubclass(model, BaseModel):
            yield from (
                field.alias or name
                for name, field in model.model_fields.items()
                if get_origin(field.annotation) is not list
            )
        elif get_origin(model) is not list:
            yield parameter.alias
