"""Read a JSON body and validate it strictly: no text or booleans for numbers, no unknown or repeated fields."""

from __future__ import annotations

from collections.abc import Container
from functools import cache
from typing import TypeVar

from fastapi import Request
from pydantic import BaseModel

from safestart.errors import InvalidInput, invalid
from safestart.model.strict_json import NotJson, validated
from safestart.runtime.plain_json import NameTwice, TooManyNames, require_unique_names
from safestart_service.errors import MalformedBody, UnsupportedMediaType
from safestart_service.http.answers import all_lines

Model = TypeVar("Model", bound=BaseModel)

MOST_PARTS = 100_000
"""Values and names in a body of a process without a list of states."""
PARTS_PER_STATE = 8


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
    coding = all_lines(request, "content-encoding") or ""
    if any(one.strip().lower() not in ("", "identity") for one in coding.split(",")):
        raise UnsupportedMediaType(
            f"Content-Encoding: required none, received {coding}",
            field="Content-Encoding",
            required="none",
            received=coding,
        )
    return await request.body()


def parse_body(model: type[Model], body: bytes, most_parts: int = MOST_PARTS) -> Model:
    """Validate bytes against a model; raises ``MalformedBody`` or ``InvalidInput``, which name the mistake.

    ``most_parts`` bounds the values and names in the body before anything is parsed.
    """
    require_bounded(body, most_parts)
    require_once(body, names_of(model))
    try:
        return validated(model, body)
    except NotJson as error:
        raise _malformed(body, str(error)) from None


def require_bounded(body: bytes, most_parts: int) -> None:
    """Raise ``InvalidInput`` for a body of too many values and names, before anything is made of them.

    Counted are the characters that separate them, those inside of texts too: this is a bound from above, and costs a
    few milliseconds and no memory.
    """
    parts = sum(body.count(mark) for mark in (b",", b":", b"{", b"["))
    if parts > most_parts:
        required = f"at most {most_parts} values and names"
        raise InvalidInput(
            f"body: required {required}, received about {parts}",
            field="body",
            required=required,
            received=parts,
        )


def _malformed(body: bytes, why: str) -> MalformedBody:
    return MalformedBody(
        f"body: {why}", field="body", required="JSON in UTF-8", received=body[:80].decode("utf-8", "replace")
    )


def require_once(body: bytes, known: Container[str] | None = None) -> None:
    """Raise ``InvalidInput`` for a name that appears twice in an object, or for very many that are not ``known``.

    A body that is not JSON is left to the parser.
    """
    try:
        require_unique_names(body, known)
    except NameTwice as error:
        raise _twice(error) from None
    except TooManyNames as error:
        raise invalid(error.name, "no field of this name", "it, and more than 1000 others") from None
    except RecursionError:
        raise _malformed(body, "it is nested too deeply") from None
    except ValueError:
        return


@cache
def names_of(model: type[BaseModel]) -> frozenset[str]:
    """The names of all fields of a model and of the models in it."""
    schema = model.model_json_schema()
    models = (schema, *schema.get("$defs", {}).values())
    return frozenset(name for one in models for name in one.get("properties", ()))


def _twice(error: NameTwice) -> InvalidInput:
    return invalid(error.name, "every name once in an object", "one that comes twice")
