"""Read a JSON body and validate it strictly: no text or booleans for numbers, no unknown or repeated fields."""

from __future__ import annotations

from typing import TypeVar

from fastapi import Request
from pydantic import BaseModel, ValidationError

from safestart.errors import invalid
from safestart.model.validation import validation_error
from safestart.runtime.plain_json import NameTwice, require_unique_names
from safestart_service.errors import MalformedBody, UnsupportedMediaType

Model = TypeVar("Model", bound=BaseModel)


async def read_body(request: Request) -> bytes:
    """The body's bytes, if the request declares JSON; :mod:`limits` enforces the caps."""
    received = request.headers.get("content-type", "")
    kind = received.partition(";")[0].strip().lower()
    if kind != "application/json" and not (kind.startswith("application/") and kind.endswith("+json")):
        raise UnsupportedMediaType(
            f"Content-Type: required application/json, received {received or 'none'}",
            field="Content-Type",
            required="application/json",
            received=received or None,
        )
    coding = request.headers.get("content-encoding", "identity")
    if coding.strip().lower() not in ("", "identity"):
        raise UnsupportedMediaType(
            f"Content-Encoding: required none, received {coding}",
            field="Content-Encoding",
            required="none",
            received=coding,
        )
    return await request.body()


def parse_body(model: type[Model], body: bytes) -> Model:
    """Validate bytes against a model; raises ``MalformedBody`` or ``InvalidInput``, which name the mistake.

    pydantic parses and validates in one pass, which makes 100 000 states affordable.
    """
    try:
        found = model.model_validate_json(body, strict=True)
    except ValidationError as error:
        # Take the first report only: listing those of a hundred thousand unknown fields takes a second.
        only = error.errors(include_url=False)[0] if error.error_count() == 1 else None
        if only is not None and only["type"] == "json_invalid":
            raise MalformedBody(
                f"body: {only['msg']}",
                field="body",
                required="JSON in UTF-8",
                received=body[:80].decode("utf-8", "replace"),
            ) from None
        raise validation_error(error) from None
    require_once(body)
    return found


def require_once(body: bytes) -> None:
    """Raise ``InvalidInput`` for a name that appears twice in an object of a JSON body."""
    try:
        require_unique_names(body)
    except NameTwice as error:
        raise invalid(error.name, "every name once in an object", "a repeated one") from None
