"""One shard of a sweep: draw, certify, fly, count.

Document: ``counts`` (nested integers that add up: cases, evaluated, undecided, confusion as [tp, fp, fn, tn], steps,
fallbacks, cells by index, false_go), ``delta_v`` per controller [flights, mean, squared differences, least, most],
``worst`` per controller, ``false_go``, ``run_s``. Data: the Parquet records of its first cases.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from safestart.processes.sharding import Part
from safestart.processes.sweep import judge
from safestart.processes.sweep.aggregate import FALSE_GO_KEPT, worst_first
from safestart.processes.sweep.cases import Cases, cases_of
from safestart.processes.sweep.fleet import Outcome, fly_all
from safestart.processes.sweep.judge import GO, NO_GO, UNASKED, UNDECIDED, Verdicts
from safestart.processes.sweep.records import parquet
from safestart.processes.sweep.spec import SweepInputs
from safestart.runtime.progress import Context

Verdict = dict[str, Verdicts]
Flown = dict[str, Outcome]


def shard(part: dict[str, Any], context: Context) -> Part:
    """Run one shard."""
    begin = time.perf_counter()
    inputs = SweepInputs.model_validate(part["inputs"])
    groups = cases_of(inputs, part["number"], part["pieces"])
    total = sum(len(cases.points) for cases in groups) * len(inputs.controllers)
    room = _share(inputs, inputs.records, part["pieces"])
    exact_left = _share(inputs, inputs.exact_cases, part["pieces"])
    tally = _Tally(inputs)
    rows: list[tuple[Cases, Verdict, Flown, int]] = []
    done = 0
    for cases in groups:
        flown: Flown = {}
        for controller in inputs.controllers:
            flown[controller] = fly_all(inputs, controller, cases, _poll(context, done, total, controller))
            done += len(cases.points)
        asked = len(cases.points) if inputs.distribution == "grid" else min(exact_left, len(cases.points))
        exact_left -= asked
        verdicts = _verdicts(inputs, cases, flown, asked)
        tally.add(cases, verdicts, flown)
        kept = min(room, len(cases.points))
        room -= kept
        if kept:
            rows.append((cases, verdicts, flown, kept))
    document = tally.document()
    data = parquet(inputs, rows)
    return Part({**document, "run_s": time.perf_counter() - begin}, data)


def _poll(context: Context, done: int, total: int, label: str) -> Callable[[int], None]:
    return lambda count: context.step(done + count, total, label)


def _share(inputs: SweepInputs, most: int, pieces: list[list[int]]) -> int:
    """This shard's part of a number spread over all cases, rounded up."""
    return math.ceil(most * sum(count for _, _, count in pieces) / inputs.total)


def _verdicts(inputs: SweepInputs, cases: Cases, flown: Flown, asked: int) -> Verdict:
    out: Verdict = {}
    for certificate in inputs.certificates:
        if certificate == "closed_form":
            out[certificate] = judge.closed_form(cases)
            continue
        known = [outcome.verdict for outcome in flown.values() if (outcome.verdict != UNASKED).all()]
        out[certificate] = known[0] if known else judge.exact(cases, inputs.steps, asked)
    return out


class _Tally:
    """The document of a shard as it grows."""

    def __init__(self, inputs: SweepInputs) -> None:
        self.inputs = inputs
        names: list[str] = [*inputs.controllers]
        certificates: list[str] = [*inputs.certificates]
        self.cases = self.undecided = self.false_gos = 0
        self.evaluated = dict.fromkeys([*certificates, *names], 0)
        self.confusion = {c: {n: np.zeros(4, np.int64) for n in names} for c in certificates}
        self.steps, self.fallbacks = dict.fromkeys(names, 0), dict.fromkeys(names, 0)
        self.cells: dict[str, dict[str, Any]] = {}
        self.impulse: dict[str, list[np.ndarray[Any, Any]]] = {name: [] for name in names}
        self.worst: dict[str, list[dict[str, Any]]] = {name: [] for name in names}
        self.false_go: list[dict[str, Any]] = []

    def add(self, cases: Cases, verdicts: Verdict, flown: Flown) -> None:
        """Count the cases of one scenario."""
        self.cases += len(cases.points)
        for certificate, verdict in verdicts.items():
            asked = verdict != UNASKED
            self.evaluated[certificate] += int(asked.sum())
            self.undecided += int((verdict == UNDECIDED).sum())
            for name, outcome in flown.items():
                certified, safe = verdict[asked] == GO, outcome.safe[asked]
                # 2 certified + safe: 3 tp, 2 fp, 1 fn, 0 tn.
                found = np.bincount(2 * certified.astype(np.int64) + safe, minlength=4)
                self.confusion[certificate][name] += found[[3, 2, 1, 0]]
        for name, outcome in flown.items():
            self.evaluated[name] += len(cases.points)
            self.steps[name] += int(outcome.steps.sum())
            self.fallbacks[name] += int(outcome.fallbacks.sum())
            self.impulse[name].append(outcome.delta_v[outcome.safe])
            self._keep_worst(name, cases, verdicts, outcome)
        if "closed_form" in verdicts and "exact" in verdicts:
            wrong = (verdicts["closed_form"] == GO) & (verdicts["exact"] == NO_GO)
            self.false_gos += int(wrong.sum())
            for row in np.nonzero(wrong)[0][: FALSE_GO_KEPT - len(self.false_go)]:
                self.false_go.append(_record(cases, verdicts, int(row), None, None))
        if cases.cells[0] >= 0:
            for cell in np.unique(cases.cells).tolist():
                self._count_cell(str(cell), cases.cells == cell, verdicts, flown)

    def _count_cell(self, key: str, here: np.ndarray[Any, Any], verdicts: Verdict, flown: Flown) -> None:
        cell = self.cells.setdefault(key, {"cases": 0, "certified": {}, "feasible": {}})
        cell["cases"] += int(here.sum())
        for name, verdict in verdicts.items():
            cell["certified"][name] = cell["certified"].get(name, 0) + int((verdict[here] == GO).sum())
        for name, outcome in flown.items():
            cell["feasible"][name] = cell["feasible"].get(name, 0) + int(outcome.safe[here].sum())

    def _keep_worst(self, name: str, cases: Cases, verdicts: Verdict, outcome: Outcome) -> None:
        if not self.inputs.worst:
            return
        certified = np.zeros(len(cases.points), np.bool_)
        for verdict in verdicts.values():
            certified |= verdict == GO
        # Flights of interest: certified starts (all starts where nothing certifies), least margin first.
        rows = np.nonzero(certified if verdicts else np.ones(len(cases.points), np.bool_))[0]
        margin = np.nan_to_num(outcome.margin[rows], nan=-math.inf)
        rows = rows[np.lexsort((rows, margin))][: self.inputs.worst]
        found = [
            _record(cases, verdicts, int(r), float(outcome.margin[r]), float(outcome.violated_at[r]))
            for r in rows
        ]
        self.worst[name] = worst_first(self.worst[name] + found, self.inputs.worst)

    def document(self) -> dict[str, Any]:
        """The shard's document without its time."""
        confusion = {
            certificate: {name: cell.tolist() for name, cell in by_name.items()}
            for certificate, by_name in self.confusion.items()
        }
        return {
            "counts": {
                "cases": self.cases,
                "evaluated": self.evaluated,
                "undecided": self.undecided,
                "confusion": confusion,
                "steps": self.steps,
                "fallbacks": self.fallbacks,
                "cells": self.cells,
                "false_go": self.false_gos,
            },
            "delta_v": {name: _spread(parts) for name, parts in self.impulse.items()},
            "worst": self.worst,
            "false_go": self.false_go,
        }


def _record(
    cases: Cases, verdicts: Verdict, row: int, margin: float | None, late: float | None
) -> dict[str, Any]:
    named = {int(GO): True, int(NO_GO): False, int(UNDECIDED): False, int(UNASKED): None}
    return {
        "case": int(cases.numbers[row]),
        "omega_t_deg_s": cases.omega_t_deg_s,
        "a_max_m_s2": cases.a_max_m_s2,
        "x_m": float(cases.points[row, 0]),
        "y_m": float(cases.points[row, 1]),
        "margin_m": margin if margin is not None and math.isfinite(margin) else None,
        "violated_at_s": late if late is not None and math.isfinite(late) else None,
        "certified": {name: named[int(verdict[row])] for name, verdict in verdicts.items()},
    }


def _spread(parts: list[np.ndarray[Any, Any]]) -> list[Any]:
    """Count, mean, sum of squared differences from the mean, least and most."""
    values = np.concatenate(parts) if parts else np.empty(0)
    if not len(values):
        return [0, 0.0, 0.0, None, None]
    mean = math.fsum(values) / len(values)
    return [len(values), mean, math.fsum((values - mean) ** 2), float(values.min()), float(values.max())]
