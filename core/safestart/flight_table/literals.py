"""Numbers as C literals of one precision, to the last bit; rounded outward where a bound is meant."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Precision:
    """``float64`` or ``float32``: C type, square root, suffix of literals; u, half a unit in the last place."""

    name: str
    ctype: str
    sqrt: str
    suffix: str
    unit: float

    def near(self, value: float) -> str:
        """The nearest number."""
        return self._text(self._rounded(value))

    def up(self, value: float) -> str:
        """A number that is not less."""
        found = self._rounded(value)
        return self._text(found if found >= value else self._next(found, math.inf))

    def down(self, value: float) -> str:
        """A number that is not more."""
        found = self._rounded(value)
        return self._text(found if found <= value else self._next(found, -math.inf))

    def row(self, values: Iterable[float]) -> str:
        """The nearest numbers, as an initializer."""
        return "{" + ", ".join(self.near(value) for value in values) + "}"

    def _rounded(self, value: float) -> float:
        return float(np.float32(value)) if self.suffix else float(value)

    def _next(self, value: float, toward: float) -> float:
        if self.suffix:
            return float(np.nextafter(np.float32(value), np.float32(toward)))
        return math.nextafter(value, toward)

    def _text(self, value: float) -> str:
        if not math.isfinite(value):
            raise ValueError("a table holds finite numbers")
        return value.hex() + self.suffix


PRECISIONS = {
    "float64": Precision("float64", "double", "sqrt", "", 2.0**-53),
    "float32": Precision("float32", "float", "sqrtf", "F", 2.0**-24),
}
