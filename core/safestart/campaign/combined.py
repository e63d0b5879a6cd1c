"""Several tallies in one: by name, or one per group of cases."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from safestart.campaign.table import Table
from safestart.campaign.tally import Tally


@dataclass(frozen=True, slots=True)
class Each:
    """Several tallies by name."""

    tallies: Mapping[str, Tally]

    def of(self, table: Table) -> dict[str, Any]:
        """By name."""
        return {name: tally.of(table) for name, tally in self.tallies.items()}

    def add(self, state: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
        """By name."""
        return {name: tally.add(state[name], more[name]) for name, tally in self.tallies.items()}

    def said(self, state: dict[str, Any]) -> dict[str, Any]:
        """By name."""
        return {name: tally.said(state[name]) for name, tally in self.tallies.items()}


@dataclass(frozen=True, slots=True)
class Grouped:
    """A tally for each value of an integer column; rows without a value are left out."""

    by: str
    tally: Tally

    def of(self, table: Table) -> dict[str, Any]:
        """By value, as text: states are JSON."""
        table = table.taken(table.known(self.by))
        table = table.taken(np.argsort(table.values[self.by], kind="stable"))
        groups, firsts = np.unique(table.values[self.by], return_index=True)
        ends = [*firsts.tolist(), len(table)][1:]
        return {
            str(value): self.tally.of(table.taken(slice(first, end)))
            for value, first, end in zip(groups.tolist(), firsts.tolist(), ends, strict=True)
        }

    def add(self, state: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
        """Value by value."""
        both = {name: self.tally.add(state[name], more[name]) for name in state if name in more}
        return {**state, **more, **both}

    def said(self, state: dict[str, Any]) -> dict[int, Any]:
        """By value, ascending."""
        return {value: self.tally.said(state[str(value)]) for value in sorted(int(name) for name in state)}
