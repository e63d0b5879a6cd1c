"""Unambiguous JSON: each name of an object appears once, and every number is finite.

With two values for one name, some readers take the first and some the last. JSON has no NaN or infinity, and 1e999
would become infinity.
"""

from __future__ import annotations

import json
import math
from collections.abc import Container
from itertools import islice
from typing import Any

from safestart.model.doubles import BELOW, is_beyond


class NameTwice(ValueError):
    """An object contains ``name`` twice."""

    def __init__(self, name: str) -> None:
        super().__init__(f"an object with the name {json.dumps(name[:100])} twice")
        self.name = name


def loads(text: str | bytes) -> Any:
    """Parse a document; raises ``NameTwice``, ``NoNumber``, or the errors of :func:`json.loads`.

    Bytes are UTF-8 without a byte order mark (RFC 8259).
    """
    text = text if isinstance(text, str) else bytes(text).decode()
    return json.loads(text, object_pairs_hook=_unique, parse_constant=_finite, parse_float=_finite)


class NoNumber(ValueError):
    """A document contains what is no number of JSON, or one beyond those of a double."""

    def __init__(self, text: str) -> None:
        self.required = BELOW if is_beyond(text) else "finite numbers (JSON has no NaN and no Infinity)"
        super().__init__(f"required {self.required}, received {text[:40]}")
        self.text = text[:40]


class TooManyNames(ValueError):
    """A document with more unknown names than a reader wants to report; ``name`` is the first of them."""

    def __init__(self, name: str) -> None:
        super().__init__(f"unknown names, the first is {json.dumps(name[:100])}")
        self.name = name


def require_unique_names(
    text: str | bytes, known: Container[str] | None = None, most_unknown: int = 1000
) -> None:
    """Raise ``NameTwice`` for an otherwise valid document, and ``TooManyNames`` for too many that are not ``known``.

    Nothing is built of the document; a reader that reports every unknown name would need memory for each.
    """
    unknown: list[str] = []

    def check(pairs: list[tuple[str, Any]]) -> None:
        if known is not None:  # first, as the comparison below takes memory for every name
            left = most_unknown + 1 - len(unknown)
            unknown.extend(islice((name for name, _ in pairs if name not in known), left))
            if len(unknown) > most_unknown:
                raise TooManyNames(unknown[0])
        _check(pairs)

    json.loads(text, object_pairs_hook=check, parse_float=len, parse_int=len)


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise NoNumber(text)
    return value


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        _check(pairs)
    return found


def _check(pairs: list[tuple[str, Any]]) -> None:
    if len({name for name, _ in pairs}) != len(pairs):
        seen: set[str] = set()
        for name, _ in pairs:
            if name in seen:
                raise NameTwice(name)
            seen.add(name)
