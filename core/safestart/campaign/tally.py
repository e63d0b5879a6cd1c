"""Counts over the cases of a campaign: each shard gives a small JSON-able state, and the states add up.

The sum does not depend on the order, except for :class:`~safestart.campaign.spread.Spread`, whose states are added
in the order of the shards. ``said`` turns the state of all cases into the document's value.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from safestart.campaign.table import Table


class Tally(Protocol):
    """One count over the cases."""

    def of(self, table: Table) -> Any:
        """State of these rows; without rows, the initial state."""
        ...

    def add(self, state: Any, more: Any) -> Any:
        """State of the rows of both."""
        ...

    def said(self, state: Any) -> Any:
        """The document's value."""
        ...


class _Number:
    """A tally whose state is a whole number."""

    def add(self, state: int, more: int) -> int:
        """Their sum."""
        return state + more

    def said(self, state: int) -> int:
        """The number."""
        return state


class Rows(_Number):
    """The number of rows."""

    def of(self, table: Table) -> int:
        """Count."""
        return len(table)


@dataclass(frozen=True, slots=True)
class Known(_Number):
    """The rows in which a column has a value."""

    column: str

    def of(self, table: Table) -> int:
        """Count."""
        return int(table.known(self.column).sum())


@dataclass(frozen=True, slots=True)
class Flagged(_Number):
    """The rows in which a flag is set."""

    column: str

    def of(self, table: Table) -> int:
        """Count."""
        return int(table.flagged(self.column).sum())


@dataclass(frozen=True, slots=True)
class Total(_Number):
    """The sum of a column of whole numbers."""

    column: str

    def of(self, table: Table) -> int:
        """Add up the known values."""
        return int(table.values[self.column][table.known(self.column)].sum())


@dataclass(frozen=True, slots=True)
class Values:
    """How often each value of a text column occurs; rows without a value are left out."""

    column: str

    def of(self, table: Table) -> dict[str, int]:
        """Count."""
        values, counts = np.unique(table.values[self.column][table.known(self.column)], return_counts=True)
        return dict(zip(values.tolist(), counts.tolist(), strict=True))

    def add(self, state: dict[str, int], more: dict[str, int]) -> dict[str, int]:
        """Value by value."""
        return {name: state.get(name, 0) + more.get(name, 0) for name in state | more}

    def said(self, state: dict[str, int]) -> dict[str, int]:
        """By value, in alphabetical order."""
        return dict(sorted(state.items()))
