"""Single-valued query parameters must not repeat: otherwise the last value would silently count."""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Iterator
from typing import Any, get_origin

from fastapi import Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from pydantic import BaseModel

from safestart.errors import invalid


class OnceRoute(APIRoute):
    """A route that refuses a second value for each of its query parameters that is not a list."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """The usual handler, after that check."""
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
    """Names of the single-valued query parameters."""
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
