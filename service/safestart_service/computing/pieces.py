"""A JSON document in pieces, each of which lets go of what it was made from.

At once, the text would be in memory beside all values, and some of it twice while it grows.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import orjson

BLOCK = 5_000
"""Items of a list that are written together."""


def pieces(document: Any) -> Iterator[bytes]:
    """The bytes of ``orjson.dumps(document)``, one after the other."""
    if isinstance(document, dict) and document:
        left = dict(document)
        del document
        before = b"{"
        for name in list(left):
            yield before + orjson.dumps(name) + b":"
            yield from pieces(left.pop(name))
            before = b","
        yield b"}"
    elif isinstance(document, list) and len(document) > BLOCK:
        before = b"["
        for first in range(0, len(document), BLOCK):
            yield before + orjson.dumps(document[first : first + BLOCK])[1:-1]
            before = b","
        yield b"]"
    else:
        yield orjson.dumps(document)
