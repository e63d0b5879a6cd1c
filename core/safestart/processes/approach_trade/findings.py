"""What an approach trade finds: the front of fuel against error level, and statements with their figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

RBAR = 90.0
UNSOLVABLE = (110.0, 180.0)
"""Angles, deg, between which paper 004 sees no hop."""
LEAST_SAVING = 20.0
"""Percent: what the statement about these angles claims."""

Row = Mapping[str, Any]


def front_of(rows: Sequence[Row]) -> list[Row]:
    """Approaches that no other one betters in fuel (2-norm) and error level, by fuel."""
    kept: list[Row] = []
    # With equal fuel the higher level comes first.
    for row in sorted(rows, key=lambda row: (row["fuel_2norm_m_s"], -row["lambda"])):
        if not kept or row["lambda"] > kept[-1]["lambda"]:
            kept.append(row)
    return kept


def findings_of(rows: Sequence[Row], demanded_risk: float) -> list[dict[str, Any]]:
    """Statements, each with the approach that shows it; UNDECIDED where more flights could still show it."""
    return [_cheapest(rows, demanded_risk), *_beyond(rows)] if rows else []


def _cheapest(rows: Sequence[Row], demanded_risk: float) -> dict[str, Any]:
    met = [row for row in rows if row["verdict"] == "MET"]
    claim = "an approach meets both demands as planned, without a barrier; the cheapest"
    if met:
        return _finding(claim, "HELD", min(met, key=lambda row: row["fuel_2norm_m_s"]), rows)
    open_ = any(row["level"] == "MET" and row["breach"]["low"] <= demanded_risk for row in rows)
    return _finding(claim, "UNDECIDED" if open_ else "BROKEN", None, rows)


def _beyond(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """The angles that the paper calls unsolvable against the R-bar, for the same hops and hold point."""
    pairs = [
        (row, base)
        for row in rows
        if UNSOLVABLE[0] < row["angle_deg"] < UNSOLVABLE[1] and (base := _rbar(row, rows)) is not None
    ]
    if not pairs:
        return []
    claim = (
        f"where the paper sees no solution (110 to 180 deg) an approach costs at least {LEAST_SAVING:g} % less "
        "fuel than the R-bar in both norms, is proved at a higher error level and had no more breaches"
    )

    def shows(row: Row, base: Row) -> bool:
        return (
            min(_saved(row, base, norm) for norm in ("1norm", "2norm")) >= LEAST_SAVING
            and row["lambda"] > base["lambda"]
            and row["breach"]["probability"] <= base["breach"]["probability"]
        )

    good = [row for row, base in pairs if shows(row, base)]
    best = min(good or [row for row, _ in pairs], key=lambda row: row["fuel_2norm_m_s"])
    return [_finding(claim, "HELD" if good else "BROKEN", best, rows)]


def _rbar(row: Row, rows: Sequence[Row]) -> Row | None:
    same = (other for other in rows if (other["hops"], other["hold_m"]) == (row["hops"], row["hold_m"]))
    return next((other for other in same if other["angle_deg"] == RBAR), None)


def _saved(row: Row, base: Row, norm: str) -> float:
    """Percent of the fuel."""
    return float(100.0 * (1.0 - row[f"fuel_{norm}_m_s"] / base[f"fuel_{norm}_m_s"]))


def _finding(claim: str, verdict: str, row: Row | None, rows: Sequence[Row]) -> dict[str, Any]:
    base = None if row is None else _rbar(row, rows)
    said = dict.fromkeys(("angle_deg", "hops", "hold_m", "fuel_1norm_m_s", "fuel_2norm_m_s", "lambda"))
    if row is not None:
        said = {name: row[name] for name in said}
    return {
        "claim": claim,
        "verdict": verdict,
        **said,
        "breach_high": None if row is None else row["breach"]["high"],
        "less_fuel_1norm_percent": None if row is None or base is None else _saved(row, base, "1norm"),
        "less_fuel_2norm_percent": None if row is None or base is None else _saved(row, base, "2norm"),
    }
