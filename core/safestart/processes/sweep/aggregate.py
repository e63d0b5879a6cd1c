"""Sums over the shards of a sweep, and what they say: added in the shards' order, bounded whatever the case count."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from safestart.model.metrics import ConfusionMatrix, ratio, wilson
from safestart.processes.sweep.spec import SweepInputs

# Of the false GOs of the closed form, this many are kept with their numbers.
FALSE_GO_KEPT = 20


def summary(inputs: SweepInputs, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """The outputs so far; ``documents`` are those of the shards, in order."""
    total = Total(inputs)
    for document in documents:
        total.add(document)
    return total.outputs()


class Total:
    """Running sums of shard documents (see ``shard.py`` for their layout)."""

    def __init__(self, inputs: SweepInputs) -> None:
        self.inputs = inputs
        self.counts: dict[str, Any] = {}
        self.worst: dict[str, list[dict[str, Any]]] = {name: [] for name in inputs.controllers}
        self.false_go: list[dict[str, Any]] = []
        self.impulse: dict[str, list[float]] = {
            n: [0, 0.0, 0.0, math.inf, -math.inf] for n in inputs.controllers
        }
        self.run_s = 0.0

    def add(self, document: dict[str, Any]) -> None:
        """Add one shard."""
        _add(self.counts, document["counts"])
        self.run_s += document["run_s"]
        self.false_go = (self.false_go + document["false_go"])[:FALSE_GO_KEPT]
        for name, found in document["worst"].items():
            self.worst[name] = worst_first(self.worst[name] + found, self.inputs.worst)
        for name, (flights, mean, spread, least, most) in document["delta_v"].items():
            if flights:
                self.impulse[name] = _pooled(self.impulse[name], [flights, mean, spread, least, most])

    def outputs(self) -> dict[str, Any]:
        """The document that ``SweepOutputs`` describes."""
        counts, inputs = self.counts, self.inputs
        return {
            "cases": counts.get("cases", 0),
            "evaluated": counts.get("evaluated", {}),
            "undecided": counts.get("undecided", 0),
            "confusion": {
                certificate: {name: confusion(cell) for name, cell in by_controller.items()}
                for certificate, by_controller in counts.get("confusion", {}).items()
            },
            "delta_v_m_s": {name: _impulse(sums) for name, sums in self.impulse.items()},
            "control_steps": counts.get("steps", {}),
            "fallbacks": counts.get("fallbacks", {}),
            "cells": [_cell(inputs, key, cell) for key, cell in _ordered(counts.get("cells", {}))],
            "worst": {name: [public(case) for case in cases] for name, cases in self.worst.items()},
            "false_go": [public(case) for case in self.false_go],
            "false_go_count": counts.get("false_go", 0),
            "notes": notes(inputs),
            "run_s": self.run_s,
        }


def worst_first(cases: list[dict[str, Any]], most: int) -> list[dict[str, Any]]:
    """Violations of certified starts first, then by margin; the number settles ties."""

    def key(case: dict[str, Any]) -> tuple[bool, float, int]:
        margin = case["margin_m"]
        lost = case["violated_at_s"] is not None and any(case["certified"].values())
        return not lost, -math.inf if margin is None else margin, case["case"]

    return sorted(cases, key=key)[:most]


def public(case: dict[str, Any]) -> dict[str, Any]:
    """A case as it goes on the wire, without what only the merge needs."""
    return {name: value for name, value in case.items() if not name.startswith("_")}


def confusion(cell: Sequence[int]) -> dict[str, Any]:
    """Counts ``(tp, fp, fn, tn)`` with their rates and intervals."""
    tp, fp, fn, tn = cell
    rate = ratio(fp, fp + tn)
    intervals = {
        "precision": wilson(tp, tp + fp),
        "recall": wilson(tp, tp + fn),
        "false_positive_rate": wilson(fp, fp + tn),
    }
    return {
        **ConfusionMatrix(tp, fp, fn, tn).document(),
        "false_positive_rate": rate,
        "false_positive_share": ratio(fp, tp + fp + fn + tn),
        "wilson_95": {name: None if pair is None else list(pair) for name, pair in intervals.items()},
    }


def notes(inputs: SweepInputs) -> list[str]:
    """What was asked of which starts, and what the figures do not say."""
    said = [
        "Flown without violation means: inside the rotating corridor for the flight time. Reaching the hold point, or "
        "staying longer, is not asked for.",
        f"filter: preset {inputs.preset}, one command per 2 s; its false positives are the controller's.",
    ]
    if "sequence" in inputs.controllers:
        said.append(
            "sequence: the least impulse that keeps a margin; it may loiter. It is always checked at all times."
        )
    if "exact" in inputs.certificates:
        if inputs.distribution == "grid" or "sequence" in inputs.controllers:
            said.append("exact: every start (thrust held for 2 s, CWH without disturbance).")
        else:
            said.append(f"exact: about the first {inputs.exact_cases} starts, spread over the shards.")
    if inputs.truth.model != "cwh":
        said.append(
            "two_body_j2: the certificates speak of CWH; the truth differs by millimetres to centimetres."
        )
    return said


def _add(total: dict[str, Any], part: dict[str, Any]) -> None:
    for name, value in part.items():
        if isinstance(value, dict):
            _add(total.setdefault(name, {}), value)
        elif isinstance(value, list):
            before = total.get(name, [0] * len(value))
            total[name] = [a + b for a, b in zip(before, value, strict=True)]
        else:
            total[name] = total.get(name, 0) + value


def _pooled(a: list[float], b: list[float]) -> list[float]:
    """Count, mean, sum of squared differences from the mean, least and most of two samples together."""
    count = a[0] + b[0]
    apart = b[1] - a[1]
    mean = a[1] + apart * b[0] / count
    spread = a[2] + b[2] + apart * apart * a[0] * b[0] / count
    return [count, mean, spread, min(a[3], b[3]), max(a[4], b[4])]


def _impulse(sums: list[float]) -> dict[str, Any]:
    count, mean, spread, least, most = sums
    if not count:
        return {"flights": 0, "mean": None, "std": None, "least": None, "most": None}
    return {"flights": count, "mean": mean, "std": math.sqrt(spread / count), "least": least, "most": most}


def _ordered(cells: dict[str, Any]) -> list[tuple[int, Any]]:
    return sorted((int(key), cell) for key, cell in cells.items())


def _cell(inputs: SweepInputs, key: int, cell: dict[str, Any]) -> dict[str, Any]:
    point, r0 = divmod(key, len(inputs.r0_m))
    a_max, omega = divmod(point, len(inputs.omega_t_deg_s))
    return {
        "a_max_m_s2": inputs.a_max_m_s2[a_max],
        "omega_t_deg_s": inputs.omega_t_deg_s[omega],
        "r0_m": inputs.r0_m[r0],
        "cases": cell["cases"],
        "certified": cell["certified"],
        "feasible": cell["feasible"],
    }
