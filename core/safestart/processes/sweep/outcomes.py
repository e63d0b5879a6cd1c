"""Verdicts and flights of the starts of one scenario as rows of the campaign's table."""

from __future__ import annotations

import numpy as np

from safestart.campaign.study import Study
from safestart.campaign.table import Table
from safestart.processes.sweep.cases import Cases
from safestart.processes.sweep.fleet import JudgedFlights
from safestart.processes.sweep.judge import GO, NO_GO, UNASKED, UNDECIDED, Verdicts


def table_of(
    study: Study, cases: Cases, verdicts: dict[str, Verdicts], flown: dict[str, JudgedFlights]
) -> Table:
    """One row per start."""
    count = len(cases.points)
    none, every = np.zeros(count, np.bool_), np.ones(count, np.bool_)
    certified = np.logical_or.reduce([none, *(verdict == GO for verdict in verdicts.values())])
    wrong = none
    if "exact" in verdicts:
        closed = [verdicts[name] == GO for name in ("certified", "paper") if name in verdicts]
        wrong = np.logical_or.reduce([none, *closed]) & (verdicts["exact"] == NO_GO)
    values = {
        "case": cases.numbers,
        "omega_t_deg_s": np.full(count, cases.omega_t_deg_s),
        "a_max_m_s2": np.full(count, cases.a_max_m_s2),
        "x_m": cases.points[:, 0],
        "y_m": cases.points[:, 1],
        "cell": np.ma.masked_less(cases.cells, 0),
        "undecided": np.logical_or.reduce([none, *(verdict == UNDECIDED for verdict in verdicts.values())]),
        "false_go": wrong,
        "watched": certified if verdicts else every,
    }
    for name, verdict in verdicts.items():
        values[f"certified_{name}"] = np.ma.masked_array(verdict == GO, verdict == UNASKED)
    for name, outcome in flown.items():
        late = outcome.violated_at
        values[f"safe_{name}"] = outcome.safe
        values[f"margin_m_{name}"] = outcome.margin
        values[f"violated_at_s_{name}"] = np.ma.masked_array(late, ~np.isfinite(late))
        values[f"delta_v_m_s_{name}"] = outcome.delta_v
        values[f"steps_{name}"] = outcome.steps
        values[f"fallbacks_{name}"] = outcome.fallbacks
        values[f"spared_{name}"] = ~(certified & np.isfinite(late))
    return Table.of(study.columns, values)
