"""Mean and standard deviation of an outcome over the cases of a campaign."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from safestart.campaign.table import Table


@dataclass(frozen=True, slots=True)
class Spread:
    """Mean, standard deviation (of the rows themselves), least and most of a column, where a flag is set."""

    column: str
    where: str | None = None

    def of(self, table: Table) -> list[Any]:
        """Count, mean, sum of squared differences from the mean, least, most."""
        rows = table.known(self.column)
        if self.where is not None:
            rows = rows & table.flagged(self.where)
        values = table.values[self.column][rows]
        if not len(values):
            return [0, 0.0, 0.0, None, None]
        mean = math.fsum(values) / len(values)
        return [len(values), mean, math.fsum((values - mean) ** 2), float(values.min()), float(values.max())]

    def add(self, state: list[Any], more: list[Any]) -> list[Any]:
        """The spread of two samples together (Chan, Golub and LeVeque 1983)."""
        if not more[0]:
            return state
        count = state[0] + more[0]
        apart = more[1] - state[1]
        mean = state[1] + apart * more[0] / count
        squares = state[2] + more[2] + apart * apart * state[0] * more[0] / count
        least = more[3] if state[3] is None else min(state[3], more[3])
        most = more[4] if state[4] is None else max(state[4], more[4])
        return [count, mean, squares, least, most]

    def said(self, state: list[Any]) -> dict[str, Any]:
        """``count``, ``mean``, ``std``, ``least``, ``most``; None without a row."""
        count, mean, squares, least, most = state
        if not count:
            return {"count": 0, "mean": None, "std": None, "least": None, "most": None}
        return {"count": count, "mean": mean, "std": math.sqrt(squares / count), "least": least, "most": most}
