"""Translate pydantic's error reports: the field, what was required, what came."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from safestart.errors import InvalidInput, SafestartError
from safestart.model.doubles import BELOW, is_beyond
from safestart.model.places import placed

_LONGEST = 120
_LISTED = 5
_SHORT = 40
_FIELD = re.compile(r"[a-z][a-z0-9_]*(\.[a-z][a-z0-9_]*)*")
_ABSENT = object()

_REQUIRED = {
    "missing": "a value",
    "extra_forbidden": "no field of this name",
    "unexpected_keyword_argument": "no field of this name",
    "greater_than": "a number > {gt}",
    "greater_than_equal": "a number >= {ge}",
    "less_than": "a number < {lt}",
    "less_than_equal": "a number <= {le}",
    "finite_number": "a finite number",
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "an integer",
    "int_parsing": "an integer",
    "int_parsing_size": "an integer of ordinary size",
    "int_from_float": "an integer",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_type": "text",
    "string_unicode": "text in Unicode",
    "tuple_type": "an array",
    "datetime_type": "a time with its zone",
    "datetime_parsing": "a time with its zone",
    "datetime_from_date_parsing": "a time with its zone",
    "timezone_aware": "a time with its zone",
    "literal_error": "one of {expected}",
    "enum": "one of {expected}",
    "string_too_short": "at least {min_length} characters",
    "string_too_long": "at most {max_length} characters",
    "string_pattern_mismatch": "text of the form {pattern}",
    "multiple_of": "a multiple of {multiple_of}",
    "too_short": "at least {min_length} items",
    "too_long": "at most {max_length} items",
    "list_type": "an array",
    "dict_type": "an object",
    "model_type": "an object",
    "dataclass_type": "an object",
    "model_attributes_type": "an object",
    "value_error": "{error}",
    "union_tag_invalid": "one of {expected_tags}",
    "union_tag_not_found": "a value",
}
"""Report type -> what was required; the names in braces come from the report's context."""


_BY_VERSION = (
    "missing",
    "extra_forbidden",
    "greater_than",
    "less_than",
    "too_",
    "string_too_",
    "string_pattern",
)


def differs_by_version(report: Any) -> bool:
    """Whether a pydantic report tells two versions of a model apart: a field, a bound, a word; not a kind of value."""
    if report["type"] in ("literal_error", "enum"):
        return isinstance(report.get("input"), str)
    return str(report["type"]).startswith(_BY_VERSION)


def required(report: Any) -> str:
    """What one pydantic report required."""
    if report["type"] == "finite_number" and is_beyond(report.get("input")):
        return BELOW
    template = _REQUIRED.get(report["type"])
    if template is None:
        return str(report["msg"])
    try:
        return template.format(**report.get("ctx", {}))
    except KeyError:
        return str(report["msg"])


def received(report: Any) -> str:
    """The received value, shortened."""
    if report["type"] == "missing" or report.get("input") is _ABSENT:
        return "nothing"
    value = report.get("input")
    if isinstance(value, list | dict) and len(value) > _SHORT:  # its text would be as long as the whole body
        return f"{'an array' if isinstance(value, list) else 'an object'} of {len(value)}"
    shown = repr(value)
    return shown if len(shown) <= _LONGEST else shown[: _LONGEST - 3] + "..."


Error = TypeVar("Error", bound=SafestartError)


def refusal(reports: Sequence[Any], prefix: str = "", others: int = 0) -> InvalidInput:
    """One exception for a list of reports: the first in full, the other fields by name; ``others`` are not listed."""
    return error_of(InvalidInput, reports, prefix, others)


def error_of(kind: type[Error], reports: Sequence[Any], prefix: str = "", others: int = 0) -> Error:
    """The same report as another error class of ours."""
    named = [_at_its_field(report) for report in reports[: 1 + _LISTED]]
    fields = [prefix + (".".join(str(part) for part in report["loc"]) or "body") for report in named]
    wanted, came = required(named[0]), received(named[0])
    detail = f"{fields[0]}: required {wanted}, received {came}"
    if len(fields) > 1:
        detail += f" (and {len(reports) - 1 + others} more: {', '.join(fields[1:])})"
    return kind(detail, field=fields[0], required=wanted, received=came)


def _at_its_field(report: Any) -> Any:
    """A rule about several fields that says "field: what is required" is reported at that field, with its value.

    So is a name that chooses between several objects, which pydantic reports at the object.
    """
    if report["type"] in ("union_tag_invalid", "union_tag_not_found"):
        name = str(report.get("ctx", {}).get("discriminator", "")).strip("'")
        value = report["input"].get(name, _ABSENT) if isinstance(report.get("input"), dict) else _ABSENT
        return {**report, "input": value, "loc": (*report["loc"], name)}
    if report["type"] != "value_error":
        return report
    name, _, wanted = str(report.get("ctx", {}).get("error", "")).partition(": ")
    given, wanted = report.get("input"), wanted.removeprefix("required ").partition(", received ")[0]
    if not wanted or not _FIELD.fullmatch(name) or not isinstance(given, dict):
        return report
    first, *rest = name.split(".")
    if first not in given and first not in report.get("fields", ()) and report["loc"]:
        own = not rest and report["loc"][-1] == first
        return {**report, "ctx": {"error": wanted}} if own else report
    for part in (first, *rest):
        given = given.get(part, _ABSENT) if isinstance(given, dict) else _ABSENT
    return {"type": "value_error", "ctx": {"error": wanted}, "input": given, "loc": (*report["loc"], name)}


def validation_error(
    error: ValidationError, prefix: str = "", model: type[BaseModel] | None = None
) -> InvalidInput:
    """Turn pydantic's error into one of our exceptions; about ``model``, its places are without tags."""
    reports: list[Any] = error.errors(include_url=False)
    return refusal(placed(model, reports) if model is not None else reports, prefix)
