"""A JSON document in pieces: at once, its text would be in memory beside its values, and part of it twice."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import orjson

BLOCK = 5_000
"""Items of a list that are written together."""


def pieces(document: Any) -> Iterator[bytes]:
    """The bytes of ``orjson.dumps(document)``, one after the other; an array is a list."""
    if isinstance(document, dict):
        yield from members(document.items())
    elif isinstance(document, (list, np.ndarray)) and len(document) > BLOCK:
        before = b"["
        for first in range(0, len(document), BLOCK):
            yield before + orjson.dumps(_listed(document[first : first + BLOCK]))[1:-1]
            before = b","
        yield b"]"
    else:
        yield orjson.dumps(_listed(document))


def members(pairs: Iterable[tuple[str, Any]]) -> Iterator[bytes]:
    """The bytes of an object with these members, each of which may be made when it is asked for."""
    before = b"{"
    for name, value in pairs:
        yield before + orjson.dumps(name) + b":"
        yield from pieces(value)
        before = b","
    yield b"}" if before == b"," else b"{}"


def _listed(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value
