"""Read a JSON body and validate it strictly: no text or booleans for numbers, no unknown or repeated fields."""

from __future__ import annotations

import json
from collections.abc import Container, Sequence
from functools import cache
from typing import Any, TypeVar

from fastapi import Request
from pydantic import BaseModel, ValidationError

from safestart.errors import InvalidInput, invalid
from safestart.model import doubles
from safestart.model.places import placed
from safestart.model.validation import refusal
from safestart.runtime.plain_json import NameTwice, TooManyNames, require_unique_names
from safestart_service.errors import MalformedBody, UnsupportedMediaType
from safestart_service.http.answers import all_lines

Model = TypeVar("Model", bound=BaseModel)

MOST_PARTS = 100_000
"""Values and names in a body of a process without a list of states."""
PARTS_PER_STATE = 8
MOST_REPORTS = 20


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

    ``most_parts`` bounds the values and names in the body before anything is parsed. pydantic parses and validates in
    one pass, which makes 100 000 states affordable.
    """
    require_bounded(body, most_parts)
    require_once(body, names_of(model))
    try:
        return model.model_validate_json(body, strict=True)
    except ValidationError as error:
        reports = error.errors(include_url=False, include_input=False)
    if len(reports) == 1 and reports[0]["type"] == "json_invalid":
        raise _malformed(body, reports[0]["msg"])
    document = json.loads(body, parse_float=doubles.read)  # it is JSON: pydantic has read it
    if _made_whole(document, reports):
        # Once: what is still no integer after this is none.
        try:
            return model.model_validate_json(json.dumps(document), strict=True)
        except ValidationError as error:
            reports = error.errors(include_url=False, include_input=False)
    # The reports name places in the document. pydantic's own copies of the inputs would be one per report.
    shown = placed(model, reports[:MOST_REPORTS])
    raise refusal(
        [{**report, "input": value_at(document, report["loc"])} for report in shown],
        others=max(0, len(reports) - MOST_REPORTS),
    )


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


def value_at(document: Any, place: Sequence[Any]) -> Any:
    """The value at a place of a report; parts of the place that name a member of a union are left out."""
    for part in place:
        if _holds(document, part):
            document = document[part]
    return document


def _holds(document: Any, part: Any) -> bool:
    there = isinstance(document, dict) and part in document
    return there or (isinstance(document, list) and isinstance(part, int) and part < len(document))


def _made_whole(document: Any, reports: Sequence[Any]) -> bool:
    """Put 31 where the document has 31.0 and a report misses an integer; whether there was such a place.

    To JSON Schema 31.0 is an integer; to pydantic in strict mode it is not.
    """
    found = False
    for report in reports:
        if report["type"] != "int_type":
            continue
        inside, key = None, None
        value = document
        for part in report["loc"]:
            if _holds(value, part):
                inside, key, value = value, part, value[part]
        if inside is not None and isinstance(value, float) and value.is_integer():
            inside[key] = int(value)
            found = True
    return found


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
