"""Rows that a campaign keeps whole: the worst, the first of a kind, or all rows of a small campaign."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.campaign.table import CASE, Array, Table


@dataclass(frozen=True, slots=True)
class Kept:
    """The first ``most`` rows in ascending order of the columns ``by``, then of the case's number.

    Unknown or non-finite values come before every number. If ``where`` names a flag, only rows with it count. The
    rows are JSON-able, with every column.
    """

    most: int
    by: tuple[str, ...] = ()
    where: str | None = None

    def of(self, table: Table) -> list[dict[str, Any]]:
        """In order."""
        if not self.most:
            return []
        if self.where is not None:
            table = table.taken(table.flagged(self.where))
        keys = [_least_first(table, name) for name in (*self.by, CASE.name)]
        return table.taken(np.lexsort(keys[::-1])[: self.most]).rows()

    def add(self, state: list[dict[str, Any]], more: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """The first of both."""
        return sorted([*state, *more], key=self._key)[: self.most]

    def said(self, state: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """The rows."""
        return state

    def _key(self, row: dict[str, Any]) -> tuple[float, ...]:
        return tuple(-math.inf if row[name] is None else row[name] for name in (*self.by, CASE.name))


@dataclass(frozen=True, slots=True)
class Listed:
    """Every row of a campaign of few cases, column by column in the order of the cases."""

    columns: tuple[str, ...]

    def of(self, table: Table) -> dict[str, list[Any]]:
        """By column."""
        return {name: table.listed(name) for name in (CASE.name, *self.columns)}

    def add(self, state: dict[str, list[Any]], more: dict[str, list[Any]]) -> dict[str, list[Any]]:
        """One after the other."""
        return {name: [*state[name], *more[name]] for name in state}

    def said(self, state: dict[str, list[Any]]) -> dict[str, list[Any]]:
        """Sorted by case."""
        cases = state[CASE.name]
        order = sorted(range(len(cases)), key=cases.__getitem__)
        return {name: [values[place] for place in order] for name, values in state.items()}


def _least_first(table: Table, name: str) -> Array:
    values = table.values[name]
    if name == CASE.name:
        return values
    values = values.astype(np.float64)
    return np.where(table.known(name) & np.isfinite(values), values, -math.inf)
