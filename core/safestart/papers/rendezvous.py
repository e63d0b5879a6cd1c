"""Published figures of others about this rendezvous, shown beside ours (other machines, other years)."""

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


HYLAA_S = {"SRA01": 2.0, "SRA04": 28.0}
"""hylaa, CPU seconds measured beside a prototype of this verifier: one abort time, box of 0.2 m."""

FLOWSTAR_NONLINEAR_S = (126.0, 129.0)
"""Flow*, nonlinear dynamics without a failure: seconds per requirement, least and most, measured likewise."""


class PublishedRow(TypedDict):
    """The competition's expected verdict of a row; least and most seconds of others, by tool. Empty: none known."""

    verdict: str
    tools_s: dict[str, tuple[float, float]]


def published_row(case: str, nonlinear: bool = False) -> PublishedRow:
    """Published figures of one of :data:`safestart.passive_safety.cases.CASES`.

    Nobody has verified a failure with nonlinear dynamics: the verdict of such a row is UNKNOWN (paper 003, section 5).
    """
    times: dict[str, tuple[float, float]] = {}
    if nonlinear:
        if case == "SRNA01":
            times["Flow*"] = FLOWSTAR_NONLINEAR_S
        return {"verdict": "SAFE" if case == "SRNA01" else "UNKNOWN", "tools_s": times}
    if case == "SRNA01":
        times["CORA"] = (CORA_SRNA01_S, CORA_SRNA01_S)
    elif case.startswith("SRA"):
        times["CORA"] = CORA_SRA_S
    if case in HYLAA_S:
        times["hylaa"] = (HYLAA_S[case], HYLAA_S[case])
    return {"verdict": "UNSAFE" if case.startswith("SRU") else "SAFE", "tools_s": times}
