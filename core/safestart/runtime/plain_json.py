"""JSON that says one thing to every reader: each field named once, every number finite."""

from __future__ import annotations

import json
import math
from typing import Any


def loads(data: bytes | str) -> Any:
    """The document in ``data``; raises ``ValueError`` for anything else, ``RecursionError`` when it is too deep.

    Of a field that is given twice one reader takes the first value and another the last; NaN and infinity are no JSON,
    and 1e999 would become one of them.
    """
    return json.loads(data, object_pairs_hook=_each_once, parse_constant=_finite, parse_float=_finite)


def _each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    out = dict(pairs)
    if len(out) != len(pairs):
        names = [name for name, _ in pairs]
        twice = sorted({name for name in names if names.count(name) > 1})
        raise ValueError(f"required each field once, received twice: {ascii(twice)[:80]}")
    return out


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"required finite numbers, received {text[:40]}")
    return value
