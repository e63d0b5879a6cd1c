"""The approaches of a trade, one case each, and the outputs made of their outcomes. Light to import."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from safestart.campaign.design import Factorial
from safestart.campaign.kept import Listed
from safestart.campaign.study import Study
from safestart.campaign.table import Column, Kind
from safestart.hopping.approach import Approach, approach, mean_motion_of
from safestart.model.metrics import ratio, wilson
from safestart.processes.approach_trade.findings import findings_of, front_of
from safestart.processes.approach_trade.spec import ApproachTradeInputs

NOTES = [
    "Plan and proof are in CWH motion about a circular orbit; the flights are about the true Earth with J2, with noise "
    "and starts off by 10 %.",
    "A breach: thrusters that die right after a hop's impulse, and a drift of abort_orbits that enters the sphere.",
    "A demanded risk is met where the Wilson interval of 95 % ends at or below it. A kappa is chosen on one set of "
    "flights and confirmed on another; its figures are of the second.",
    "lambda: every hop is proved to keep out for all errors in a box of lambda standard deviations. A drift away is "
    "proved as planned and not flown; a tightening is flown and not proved.",
]
NUMBERS = (
    *("orbits", "time_s", "fuel_1norm_m_s", "fuel_2norm_m_s", "lambda"),
    *("kappa", "kappa_fuel_1norm_m_s", "kappa_fuel_2norm_m_s", "kappa_hold_m"),
    *("away_m", "away_orbits", "away_fuel_1norm_m_s", "away_fuel_2norm_m_s", "away_lambda"),
)
COUNTS = ("breaches", "lost", "kappa_breaches")
AXES = ("hops", "hold_m", "angle_deg")


def study_of(inputs: ApproachTradeInputs) -> Study:
    """Every case is one approach, a shard of its own."""
    axes = (inputs.hops, inputs.holds_m, inputs.angles_deg)
    design = Factorial(dict(zip(AXES, [[float(x) for x in axis] for axis in axes], strict=True)))
    outcome = [
        *(Column(name, Kind.NUMBER) for name in (*AXES, *NUMBERS)),
        *(Column(name, Kind.INTEGER) for name in COUNTS),
    ]
    return Study(design, outcome, Listed((*AXES, *NUMBERS, *COUNTS)), 1, inputs.seed)


def plan_of(inputs: ApproachTradeInputs, angle_deg: float, hops: int, hold_m: float) -> Approach:
    """The approach as planned; raises ``InvalidInput`` for an angle past a hop's fold."""
    n = mean_motion_of(inputs.semi_major_axis_m)
    return approach(n, angle_deg, inputs.start_m, hold_m, hops)


def split(inputs: ApproachTradeInputs) -> list[dict[str, Any]]:
    """The shards."""
    return study_of(inputs).parts(inputs.model_dump(mode="json"))


def summary(inputs: ApproachTradeInputs, documents: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """Findings and approaches of the given shards."""
    columns = study_of(inputs).total(documents).said
    names = [name for name in columns if name != "case"]
    rows = [
        _row(inputs, dict(zip(names, values, strict=True)))
        for values in zip(*(columns[name] for name in names), strict=True)
    ]
    front = front_of(rows)
    for row in rows:
        row["pareto"] = row in front
    return {
        "findings": findings_of(rows, inputs.demand.breach),
        "front": [
            {name: row[name] for name in ("angle_deg", "hops", "hold_m", "fuel_2norm_m_s", "lambda")}
            for row in front
        ],
        "approaches": rows,
        "notes": NOTES,
    }


def _row(inputs: ApproachTradeInputs, said: Mapping[str, Any]) -> dict[str, Any]:
    """One approach on the wire, without its place on the front."""
    demand, runs = inputs.demand, inputs.runs
    breach = _breach(said["breaches"], said["lost"], runs)
    tightening = None if said["kappa"] is None else _tightening(said, runs)
    away = None
    if said["away_m"] is not None:
        away = {
            "drift_m_per_orbit": said["away_m"],
            "orbits": said["away_orbits"],
            "fuel_1norm_m_s": said["away_fuel_1norm_m_s"],
            "fuel_2norm_m_s": said["away_fuel_2norm_m_s"],
            "lambda": said["away_lambda"],
        }
    risk, level = "MET", "MET"
    if breach["high"] > demand.breach:
        risk = "REMEDIED" if tightening else "NOT_MET" if breach["low"] > demand.breach else "UNDECIDED"
    if said["lambda"] < demand.error_level:
        level = "REMEDIED" if away else "NOT_MET"
    worst = next(word for word in ("NOT_MET", "UNDECIDED", "REMEDIED", "MET") if word in (risk, level))
    return {
        "angle_deg": said["angle_deg"],
        "hops": int(said["hops"]),
        "hold_m": said["hold_m"],
        "verdict": worst,
        "risk": risk,
        "level": level,
        **{name: said[name] for name in ("orbits", "time_s", "fuel_1norm_m_s", "fuel_2norm_m_s", "lambda")},
        "breach": breach,
        "lost": said["lost"],
        "tightening": tightening,
        "away": away,
    }


def _breach(breaches: int, lost: int, runs: int) -> dict[str, Any]:
    low, high = interval(breaches, lost, runs)
    return {
        "probability": ratio(breaches + lost, runs),
        "low": low,
        "high": high,
        "count": breaches,
        "runs": runs,
        "per_hop": [],
    }


def interval(breaches: int, lost: int, runs: int) -> tuple[float, float]:
    """Wilson interval of 95 %: its lower end with no lost run a breach, its upper end with all of them."""
    least, most = wilson(breaches, runs), wilson(breaches + lost, runs)
    return (0.0, 1.0) if least is None or most is None else (least[0], most[1])


def _tightening(said: Mapping[str, Any], runs: int) -> dict[str, Any]:
    low, high = interval(said["kappa_breaches"], 0, runs)
    return {
        "kappa": said["kappa"],
        "breach_low": low,
        "breach_high": high,
        "breaches": said["kappa_breaches"],
        "fuel_1norm_m_s": said["kappa_fuel_1norm_m_s"],
        "fuel_2norm_m_s": said["kappa_fuel_2norm_m_s"],
        "hold_m": said["kappa_hold_m"],
    }
