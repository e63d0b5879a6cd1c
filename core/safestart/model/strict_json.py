"""Values of JSON validated strictly, by the same rule wherever they come from: a body, a file, an option, Python.

No text or boolean counts as a number, and 31.0 is the integer 31, as in JSON Schema. Where one channel took ``true``
for 1.0 it would answer another question than the one that was asked, and than the other channels.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError
from pydantic_core import PydanticSerializationError, to_json

from safestart.errors import InvalidInput, invalid
from safestart.model import doubles
from safestart.model.places import placed
from safestart.model.validation import refusal

Model = TypeVar("Model", bound=BaseModel)
Place = tuple[int | str, ...]

MOST_REPORTS = 20


class NotJson(ValueError):
    """A text that is no JSON; its message says why."""


def _same(place: Place) -> Place:
    return place


def validated(model: type[Model], text: bytes, shown: Callable[[Place], Place] = _same) -> Model:
    """Validate a JSON text; raises ``InvalidInput``, which names the mistake, and ``NotJson``.

    pydantic parses and validates in one pass, which makes 100 000 states affordable. ``shown`` turns the place of a
    mistake into the one that the caller knows.
    """
    try:
        return model.model_validate_json(text, strict=True)
    except ValidationError as error:
        reports = error.errors(include_url=False, include_input=False)
    if len(reports) == 1 and reports[0]["type"] == "json_invalid":
        raise NotJson(reports[0]["msg"])
    document = json.loads(text, parse_float=doubles.read)  # it is JSON: pydantic has read it
    if _made_whole(document, reports):
        # Once: what is still no integer after this is none.
        try:
            return model.model_validate_json(json.dumps(document), strict=True)
        except ValidationError as error:
            reports = error.errors(include_url=False, include_input=False)
    # The reports name places in the document. pydantic's own copies of the inputs would be one per report.
    raise refusal(
        [
            {**report, "input": value_at(document, report["loc"]), "loc": shown(report["loc"])}
            for report in placed(model, reports[:MOST_REPORTS])
        ],
        others=max(0, len(reports) - MOST_REPORTS),
    )


def validated_values(
    model: type[Model], values: Mapping[str, Any], shown: Callable[[Place], Place] = _same
) -> Model:
    """Validate values as the JSON that they come to; raises as :func:`validated`.

    NumPy's numbers and arrays are JSON, too; an object that is none is refused.
    """
    try:
        return validated(model, json_of(values), shown)
    except NotJson:  # deeper than any model
        raise invalid("body", "JSON that is nested less deeply", "more") from None


def json_of(values: Any) -> bytes:
    """The JSON of values from Python or NumPy; raises ``InvalidInput`` for what has none."""
    try:
        return to_json(values, inf_nan_mode="constants", fallback=_plain)
    except PydanticSerializationError as error:
        why = str(error).removeprefix("Error serializing to JSON: ")
        required = "values of JSON (objects, arrays, numbers, text in Unicode, true, false, null)"
        raise InvalidInput(
            f"body: required {required}, received others ({why})",
            field="body",
            required=required,
            received=why,
        ) from None


def value_at(document: Any, place: Sequence[Any]) -> Any:
    """The value at a place of a report; parts of the place that name a member of a union are left out."""
    for part in place:
        if _holds(document, part):
            document = document[part]
    return document


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(type(value).__name__)


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
