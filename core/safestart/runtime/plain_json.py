"""Unambiguous JSON: each name of an object appears once, and every number is finite.

With two values for one name, some readers take the first and some the last. JSON has no NaN or infinity, and 1e999
would become infinity.
"""

from __future__ import annotations

import json
import math
from typing import Any


class NameTwice(ValueError):
    """An object contains ``name`` twice."""

    def __init__(self, name: str) -> None:
        super().__init__(f"an object with the name {json.dumps(name[:100])} twice")
        self.name = name


def loads(text: str | bytes) -> Any:
    """Parse a document; raises ``NameTwice``, or ``ValueError`` and ``RecursionError`` as :func:`json.loads`."""
    return json.loads(text, object_pairs_hook=_unique, parse_constant=_finite, parse_float=_finite)


def require_unique_names(text: str | bytes) -> None:
    """Raise ``NameTwice`` when an otherwise valid document repeats a name; builds no objects."""
    json.loads(text, object_pairs_hook=_check, parse_float=len, parse_int=len)


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"required finite numbers, received {text[:40]}")
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
