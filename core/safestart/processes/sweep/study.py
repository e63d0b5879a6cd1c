"""The outcome of each start of a sweep, the tallies, and the outputs. Light to import: the service uses it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from safestart.campaign.combined import Each, Grouped
from safestart.campaign.design import Design, Drawn, Factorial
from safestart.campaign.kept import Kept
from safestart.campaign.rates import Confusion
from safestart.campaign.spread import Spread
from safestart.campaign.study import Study
from safestart.campaign.table import Column, Kind
from safestart.campaign.tally import Flagged, Known, Rows, Tally, Total
from safestart.dynamics.registry import CWH, MOTIONS
from safestart.processes.sweep.controllers import CONTROLLERS
from safestart.processes.sweep.inputs import SweepInputs
from safestart.processes.sweep.split import DRAWN_OWN

# Number of the closed forms' false GOs that are kept with their case numbers.
FALSE_GO_KEPT = 20


def cells_of(inputs: SweepInputs) -> Factorial:
    """The cells of a grid, operating points slowest."""
    return Factorial(
        {"a_max_m_s2": inputs.a_max_m_s2, "omega_t_deg_s": inputs.omega_t_deg_s, "r0_m": inputs.r0_m}
    )


def drawn_of(inputs: SweepInputs) -> Drawn:
    """The starts of the other distributions; ``side`` is the angle as a share of the corridor's widest."""
    axes = {"omega_t_deg_s": inputs.omega_t_deg_s, "a_max_m_s2": inputs.a_max_m_s2, "r0_m": inputs.r0_m}
    ranges = {name: (min(values), max(values)) for name, values in axes.items()} | {"side": (-1.0, 1.0)}
    stratified = inputs.distribution == "latin_hypercube"
    return Drawn(ranges, inputs.cases, inputs.seed, stratified, DRAWN_OWN)


def study_of(inputs: SweepInputs) -> Study:
    """The campaign of a sweep."""
    design: Design = drawn_of(inputs)
    if inputs.distribution == "grid":
        design = Factorial({**cells_of(inputs).axes, "start": range(inputs.cases_per_cell)})
    return Study(design, outcome_of(inputs), tally_of(inputs), records=inputs.records)


def outcome_of(inputs: SweepInputs) -> list[Column]:
    """The start, one verdict per certificate (unknown: not asked), and the flight of each controller.

    Not recorded: ``cell`` (unknown outside a grid); ``undecided``: the exact answer is UNDECIDED; ``false_go``: a
    closed form certifies a start that exact proves NO_GO; ``watched``: certified by any, or by none asked;
    ``spared_...``: not one of the certified starts that violated.
    """
    columns = [Column(name, Kind.NUMBER) for name in ("omega_t_deg_s", "a_max_m_s2", "x_m", "y_m")]
    columns += [Column(f"certified_{name}", Kind.FLAG) for name in inputs.certificates]
    for name in inputs.controllers:
        columns.append(Column(f"safe_{name}", Kind.FLAG))
        columns += [
            Column(f"{what}_{name}", Kind.NUMBER) for what in ("margin_m", "violated_at_s", "delta_v_m_s")
        ]
        columns += [Column(f"{what}_{name}", Kind.SMALL) for what in ("steps", "fallbacks")]
    columns.append(Column("cell", Kind.INTEGER, recorded=False))
    flags = ("undecided", "false_go", "watched", *(f"spared_{name}" for name in inputs.controllers))
    return columns + [Column(name, Kind.FLAG, recorded=False) for name in flags]


def tally_of(inputs: SweepInputs) -> Each:
    """Counts, impulse, cells, and the kept rows."""
    certificates: list[str] = [*inputs.certificates]
    flown: list[str] = [*inputs.controllers]
    evaluated: dict[str, Tally] = {name: Known(f"certified_{name}") for name in certificates}
    certified: dict[str, Tally] = {name: Flagged(f"certified_{name}") for name in certificates}
    confusion = {c: Each({n: Confusion(f"certified_{c}", f"safe_{n}") for n in flown}) for c in certificates}
    cell = Each(
        {
            "cases": Rows(),
            "certified": Each(certified),
            "feasible": Each({name: Flagged(f"safe_{name}") for name in flown}),
        }
    )
    worst = {name: Kept(inputs.worst, (f"spared_{name}", f"margin_m_{name}"), "watched") for name in flown}
    return Each(
        {
            "cases": Rows(),
            "evaluated": Each(evaluated | {name: Rows() for name in flown}),
            "undecided": Flagged("undecided"),
            "confusion": Each(confusion),
            "delta_v_m_s": Each({name: Spread(f"delta_v_m_s_{name}", f"safe_{name}") for name in flown}),
            "control_steps": Each({name: Total(f"steps_{name}") for name in flown}),
            "fallbacks": Each({name: Total(f"fallbacks_{name}") for name in flown}),
            "cells": Grouped("cell", cell),
            "worst": Each(worst),
            "false_go": Kept(FALSE_GO_KEPT, where="false_go"),
            "false_go_count": Flagged("false_go"),
        }
    )


def summary(inputs: SweepInputs, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """The outputs so far, from the documents of the shards."""
    total = study_of(inputs).total(documents)
    said, cells = total.said, cells_of(inputs)
    return {
        **said,
        "delta_v_m_s": {name: _impulse(spread) for name, spread in said["delta_v_m_s"].items()},
        "cells": [{**cells.at(key), **cell} for key, cell in said["cells"].items()],
        "worst": {name: [_start(inputs, row, name) for row in rows] for name, rows in said["worst"].items()},
        "false_go": [_start(inputs, row) for row in said["false_go"]],
        "notes": notes(inputs),
        "run_s": total.run_s,
    }


def _impulse(spread: dict[str, Any]) -> dict[str, Any]:
    return {"flights" if name == "count" else name: value for name, value in spread.items()}


def _start(inputs: SweepInputs, row: dict[str, Any], controller: str | None = None) -> dict[str, Any]:
    """A kept row in its wire form; without a controller nothing was flown."""
    return {
        **{name: row[name] for name in ("case", "omega_t_deg_s", "a_max_m_s2", "x_m", "y_m")},
        "margin_m": row[f"margin_m_{controller}"] if controller else None,
        "violated_at_s": row[f"violated_at_s_{controller}"] if controller else None,
        "certified": {name: row[f"certified_{name}"] for name in inputs.certificates},
    }


def notes(inputs: SweepInputs) -> list[str]:
    """Notes: which starts were asked what, and what the figures leave out."""
    said = [
        "Flown without violation means: inside the rotating corridor for the flight time. Reaching the hold point, or "
        "staying longer, is not asked for.",
        f"filter: preset {inputs.preset}, one command per 2 s; its false positives are the controller's.",
    ]
    said += [f"{name}: {note}" for name in inputs.controllers if (note := CONTROLLERS[name].note)]
    if "exact" in inputs.certificates:
        if inputs.distribution == "grid" or "sequence" in inputs.controllers:
            said.append("exact: every start (thrust held for 2 s, CWH without disturbance).")
        else:
            said.append(f"exact: about the first {inputs.exact_cases} starts, spread over the shards.")
    if inputs.truth.model != CWH:
        note = MOTIONS[inputs.truth.model].note
        said.append(f"{inputs.truth.model}: the certificates speak of CWH{note and f'; {note}'}.")
    return said
