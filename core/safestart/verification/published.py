"""Figures that others published about this rendezvous, to be shown beside ours (other machines, other years)."""

from __future__ import annotations

from typing import TypedDict

PAPER_S: dict[str, dict[str, float | None]] = {
    "SDVTool": {"all": 5.5},
    "SpaceEx": {"thrust": 6.2, "los": 6.4, "velocity": 6.5, "separation": 6.5},
    "C2E2": {"thrust": 85.0, "los": 20.0, "velocity": 17.8, "separation": None},
}
"""Paper 003, Table 1: seconds per requirement; linear model, aborts in [120, 125] min, 240 min. None: not verified."""

CORA_SRNA01_S = 88.5
"""CORA, continuous integration runs: the row without a failure, s."""

CORA_SRA_S = (19.0, 359.0)
"""CORA, continuous integration runs: range over SRA01-SRA08, s."""


class PublishedRow(TypedDict):
    """What the competition expects of a row, and the times (s) that were published for it: least and most."""

    verdict: str
    tool: str | None
    run_s: tuple[float, float] | None


def published_row(case: str) -> PublishedRow:
    """Published figures of one of :data:`safestart.verification.cases.CASES`."""
    if case == "SRNA01":
        return {"verdict": "SAFE", "tool": "CORA", "run_s": (CORA_SRNA01_S, CORA_SRNA01_S)}
    if case.startswith("SRA"):
        return {"verdict": "SAFE", "tool": "CORA", "run_s": CORA_SRA_S}
    return {"verdict": "UNSAFE", "tool": None, "run_s": None}
