"""How a page shows an approach trade: findings, the approaches, fuel against level and risk."""

from __future__ import annotations

from safestart.processes.views import Column, Findings, Layer, Picture, Rows, View

_APPROACH = (Column("angle [deg]", "angle_deg"), Column("hops", "hops"), Column("hold [m]", "hold_m"))

VIEWS: tuple[View, ...] = (
    Findings(
        "Findings",
        "findings",
        word="verdict",
        columns=(
            Column("claim", "claim"),
            *_APPROACH,
            Column("fuel, 2-norm [m/s]", "fuel_2norm_m_s"),
            Column("lambda", "lambda"),
            Column("breach at most", "breach_high"),
            Column("less than the R-bar, 1-norm [%]", "less_fuel_1norm_percent"),
            Column("2-norm [%]", "less_fuel_2norm_percent"),
        ),
        good=("HELD", "MET", "REMEDIED"),
        bad=("BROKEN", "NOT_MET"),
    ),
    Picture(
        "Fuel against the error level that is proved",
        "fuel, 2-norm [m/s]",
        "lambda",
        (
            Layer(
                "the front: less fuel or a higher level",
                "line",
                "front",
                "fuel_2norm_m_s",
                "lambda",
                colour="soft",
            ),
            Layer("approaches, by the demand", "points", "approaches", "fuel_2norm_m_s", "lambda", "verdict"),
        ),
    ),
    Rows(
        "Approaches",
        "approaches",
        (
            *_APPROACH,
            Column("demand", "verdict"),
            Column("orbits", "orbits"),
            Column("fuel, 1-norm [m/s]", "fuel_1norm_m_s"),
            Column("2-norm [m/s]", "fuel_2norm_m_s"),
            Column("abort breach", "breach.probability"),
            Column("from (95 %)", "breach.low"),
            Column("to", "breach.high"),
            Column("lambda", "lambda"),
            Column("on the front", "pareto"),
            Column("least kappa", "tightening.kappa"),
            Column("breach with kappa at most", "tightening.breach_high"),
            Column("fuel with kappa, 2-norm [m/s]", "tightening.fuel_2norm_m_s"),
            Column("least drift away [m/orbit]", "away.drift_m_per_orbit"),
            Column("fuel away, 2-norm [m/s]", "away.fuel_2norm_m_s"),
            Column("lambda away", "away.lambda"),
        ),
    ),
)
