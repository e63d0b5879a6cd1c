"""Numbers beyond what a double holds: reading 1e400 gives infinity, which is not what was written."""

from __future__ import annotations

import math
from typing import Any

BELOW = "a number whose size a double can hold (below 1.8e308)"


class Beyond(float):
    """An infinite number that shows the digits it was read from."""

    text: str

    def __repr__(self) -> str:
        return self.text


def read(text: str) -> float:
    """The number of a JSON text, for ``parse_float``."""
    value = float(text)
    if math.isfinite(value):
        return value
    beyond = Beyond(value)
    beyond.text = text
    return beyond


def is_beyond(received: Any) -> bool:
    """Whether this is the text of a finite number, or was read from one, that a double cannot hold."""
    return str(received).strip().lstrip("+-")[:1] in tuple("0123456789.")
