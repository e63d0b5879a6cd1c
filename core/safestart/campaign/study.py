"""A whole campaign: its cases, the outcome of each, and the tally of all. Light to import."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from safestart.campaign.case import Case
from safestart.campaign.cuts import runs
from safestart.campaign.design import Design
from safestart.campaign.part import Part
from safestart.campaign.table import CASE, Column, Table
from safestart.campaign.tally import Tally
from safestart.runtime.progress import Context

Simulate = Callable[[Case, Context], Mapping[str, Any]]
"""The outcome of one case, by column; None where a value is unknown.

A numerical failure is an outcome, too: a flag or a text marks it, and the case does not count as a success.
"""


@dataclass(frozen=True, slots=True)
class Totals:
    """The joint result of ``shards`` finished shards, and the seconds they took."""

    said: Any
    shards: int
    run_s: float


@dataclass(frozen=True, slots=True)
class Study:
    """A campaign over the cases of ``design``, at most ``per_shard`` to a shard.

    ``outcome`` are the columns of a case's outcome, ``tally`` what is counted over them. The first ``records`` cases,
    spread evenly over the shards, are recorded as Parquet.
    """

    design: Design
    outcome: Sequence[Column]
    tally: Tally
    per_shard: int = 1
    seed: int = 0
    records: int = 0

    @property
    def columns(self) -> tuple[Column, ...]:
        """The case's number and its outcome."""
        return (CASE, *self.outcome)

    def parts(self, inputs: dict[str, Any]) -> list[dict[str, Any]]:
        """One ``{"inputs", "first", "count"}`` per shard."""
        cut = runs(len(self.design), self.per_shard)
        return [{"inputs": inputs, "first": first, "count": count} for first, count in cut]

    def simulated(
        self, part: dict[str, Any], simulate: Simulate, context: Context, word: str = "case"
    ) -> Part:
        """One shard, case by case; ``word`` is what progress calls a case."""
        begin = time.perf_counter()
        first, count = part["first"], part["count"]
        rows = []
        for number, parameters in enumerate(self.design.parameters(first, count)):
            label = f"{word} {number + 1} of {count}"
            context.step(number, count, label)
            case = Case(first + number, self.seed, parameters)
            outcome = simulate(case, context.part(number, 1.0, count, label))
            rows.append({CASE.name: case.index, **outcome})
        return self.part(first, Table.of_rows(self.columns, rows), time.perf_counter() - begin)

    def part(self, number: int, table: Table, run_s: float) -> Part:
        """One shard from its table, for studies that simulate many cases at once; ``number`` grows with the shards."""
        recorded = math.ceil(self.records * len(table) / len(self.design))
        data = b""
        if recorded:
            from safestart.campaign.records import parquet

            data = parquet(table.taken(slice(recorded)))
        return Part({"number": number, "tally": self.tally.of(table), "run_s": run_s}, data)

    def total(self, documents: Iterable[dict[str, Any]]) -> Totals:
        """The joint result of some or all shards, in any order."""
        state = self.tally.of(Table.joined(self.columns, ()))
        run_s, shards = 0.0, 0
        for document in sorted(documents, key=lambda one: int(one["number"])):
            state = self.tally.add(state, document["tally"])
            run_s += document["run_s"]
            shards += 1
        return Totals(self.tally.said(state), shards, run_s)

    def recorded(self, parts: Sequence[Part]) -> bytes:
        """The records of all shards in one Parquet file, in the order of the shards; empty without any."""
        if not any(part.data for part in parts):
            return b""
        from safestart.campaign.records import joined

        ordered = sorted(parts, key=lambda one: int(one.document["number"]))
        return joined(self.columns, (part.data for part in ordered))
