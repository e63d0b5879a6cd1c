"""The table of the competition: every row at both half-widths, ours beside the published figures."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from safestart.papers.rendezvous import PAPER_S, published_row
from safestart.passive_safety.cases import CASES, HALF_WIDTHS, HORIZON
from safestart.passive_safety.model import PUBLISHED, Dynamics, System
from safestart.passive_safety.question import Question
from safestart.passive_safety.verify import verify
from safestart.runtime.progress import Context

REQUIREMENTS = ("separation", "thrust", "los", "velocity", "velocity_disc")
"""Requirements in the order of the table."""

PAPER_JOB = Question(horizon=240.0, window=(120.0, 125.0))
"""The job timed in paper 003: aborts in [120, 125] min, 4 hours."""


def paper_row(system: System = PUBLISHED) -> dict[str, Any]:
    """The paper's own job with its published times."""
    return _row("paper 003", replace(PAPER_JOB, system=system)) | {
        "published": {"verdict": "SAFE", "tools_s": PAPER_S}
    }


def competition_rows(context: Context | None = None, system: System = PUBLISHED) -> list[dict[str, Any]]:
    """22 rows: verdict per requirement, margins, proved distance, counter-example, seconds, published figures."""
    context = context or Context()
    rows: list[dict[str, Any]] = []
    for case, window in CASES.items():
        for half_width in HALF_WIDTHS:
            context.step(len(rows), len(CASES) * len(HALF_WIDTHS), f"{case}, {half_width:g} m")
            row = _row(case, Question(horizon=HORIZON, window=window, box=half_width, system=system))
            rows.append(row | {"published": published_row(case, system.dynamics is Dynamics.NONLINEAR)})
    return rows


def _row(case: str, question: Question) -> dict[str, Any]:
    answer = verify(question)
    findings = answer.findings
    row: dict[str, Any] = {
        "case": case,
        "half_width_m": question.box,
        "horizon_min": question.horizon,
        "abort_window_min": None if question.window is None else list(question.window),
    }
    row |= {name: findings[name].verdict.value for name in REQUIREMENTS}
    row["margins"] = {name: findings[name].margin for name in REQUIREMENTS}
    row["distance_proved_m"] = findings["separation"].bound
    row["counter_example"] = findings["separation"].counter_example
    row["run_s"] = answer.run_s
    return row
