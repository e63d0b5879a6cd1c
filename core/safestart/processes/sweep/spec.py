"""sweep: which certified starts really fly, over many starts and controllers (paper 000, Table 3)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from safestart.model.scenario import MAX_MEAN_MOTION, MAX_RANGE
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.sharding import Sharding
from safestart.processes.views import Column, Facts, Flights, Matrices, Rows
from safestart.processes.wire import (
    DISTINCT,
    DT_S,
    Confusion,
    CorridorInput,
    Horizon,
    Seed,
    Thrust,
    TumbleRate,
)

Controller = Literal["filter", "filter_fine", "sequence"]
CertificateName = Literal["certified", "paper", "exact"]
RENAMED = {"closed_form": "paper"}
"""Deprecated names of certificates, still taken."""


def _by_present_name(names: Any) -> Any:
    return [RENAMED.get(name, name) for name in names] if isinstance(names, list) else names


FINE_DT_S = 0.5
MAX_CASES = 10_000_000
# Flown interval by interval from Python, or with a scenario of its own per case.
MAX_SLOW_CASES = 200_000

Rates = Annotated[list[TumbleRate], Field(min_length=1, max_length=50), DISTINCT]
Thrusts = Annotated[list[Thrust], Field(min_length=1, max_length=50), DISTINCT]
Ranges = Annotated[
    list[Annotated[float, Field(gt=0, le=MAX_RANGE)]], Field(min_length=1, max_length=50), DISTINCT
]
Sigma = Annotated[float, Field(ge=0, le=100)]


class TruthInput(WireModel):
    """The flown world."""

    model: Literal["cwh", "two_body_j2"] = Field(
        "cwh",
        description="cwh: exact linear motion; two_body_j2: nonlinear two-body motion with J2 (DOP853).",
    )
    check: Literal["continuous", "substeps", "nodes"] = Field(
        "continuous",
        description="Where to look for a violation: at all times, at the paper's three sub-steps, at control nodes.",
    )
    navigation_position_sigma_m: Sigma = Field(
        0.0, description="White navigation noise per axis and step, m."
    )
    navigation_velocity_sigma_m_s: Sigma = Field(
        0.0, description="White navigation noise per axis and step, m/s."
    )
    thrust_magnitude_sigma: Sigma = Field(0.0, description="Relative error of each held thrust.")
    thrust_direction_sigma_deg: Sigma = Field(0.0, description="Direction error of each held thrust, deg.")
    minimum_impulse_m_s: Sigma = Field(
        0.0, description="Impulse per interval below which no thruster fires, m/s."
    )


class FilterInput(WireModel):
    """Single settings of the filter in place of the preset's; null leaves the preset's."""

    closing_factor: float | None = Field(
        None, ge=0, le=10, description="c of the speed cap c sqrt(a_max r0)."
    )
    braking_share: float | None = Field(
        None, ge=0, le=1, description="Share of a_max planned for braking; 0: no such cap."
    )
    move_weight: float | None = Field(None, ge=0, le=1000, description="w_du of eq. (7).")
    corridor_margin_m: float | None = Field(None, ge=0, le=10, description="Margin of eq. (7), m.")
    disk_projection: bool = Field(
        True,
        description="Whether the command is cut to the thrust disk after the solve; false delivers the box.",
    )


class SweepInputs(WireModel):
    """Ranges of the paper by default: 5 x 3 operating points, 4 ranges, 9 starts each, at rest in LVLH, 60 s."""

    controllers: Annotated[list[Controller], DISTINCT] = Field(
        ["filter", "sequence"],
        min_length=1,
        max_length=3,
        description="filter: the paper's; filter_fine: the same commanded every 0.5 s; sequence: MPC over the whole "
        "thrust sequence.",
    )
    certificates: Annotated[list[CertificateName], DISTINCT, BeforeValidator(_by_present_name)] = Field(
        ["certified", "paper", "exact"],
        max_length=3,
        description="certified: explicit manoeuvres with a proof. paper (formerly closed_form): the conditions of "
        "Iskender et al., not sound. exact: cone programs.",
    )
    preset: Literal["tuned", "paper"] = Field("tuned", description="Gains of the filter.")
    filter: FilterInput = Field(default_factory=FilterInput)
    distribution: Literal["grid", "monte_carlo", "latin_hypercube"] = Field(
        "grid",
        description="grid: every combination of the values, cases_per_cell starts each, at a random angle inside the "
        "corridor; otherwise `cases` starts with omega_t, a_max, r0 and angle drawn between the least and greatest.",
    )
    omega_t_deg_s: Rates = Field([1.0, 2.0, 3.0, 4.0, 5.0], description="Tumble rates, deg/s.")
    a_max_m_s2: Thrusts = Field([0.02, 0.05, 0.10], description="Thrust accelerations, m/s^2.")
    r0_m: Ranges = Field([30.0, 50.0, 100.0, 150.0], description="Ranges of the starts, m.")
    cases_per_cell: int = Field(9, ge=1, le=MAX_CASES, description="Starts per cell of the grid.")
    cases: int = Field(500, ge=1, le=MAX_SLOW_CASES, description="Starts of the other distributions.")
    horizon_s: Horizon = Field(60.0, description="Flight time, s; a multiple of 2 s.")
    truth: TruthInput = Field(default_factory=TruthInput)
    mean_motion_rad_s: float = Field(1.1e-3, ge=0, le=MAX_MEAN_MOTION, description="Mean motion, rad/s.")
    corridor: CorridorInput = Field(default_factory=CorridorInput)
    exact_cases: int = Field(
        2000,
        ge=0,
        le=MAX_SLOW_CASES,
        description="Starts of the other distributions that get the exact certificate when no sequence is flown; on a "
        "grid every start gets it.",
    )
    records: int = Field(100_000, ge=0, le=1_000_000, description="Starts recorded in cases.parquet at most.")
    worst: int = Field(5, ge=0, le=20, description="Flights kept for replay per controller.")
    seed: Seed = 0

    @model_validator(mode="after")
    def _sensible(self) -> SweepInputs:
        if min(self.r0_m) <= self.corridor.r_h_m:
            raise ValueError("r0_m: more than corridor.r_h_m")
        if self.total > MAX_CASES:
            raise ValueError(f"cases_per_cell: at most {MAX_CASES} cases in all, not {self.total}")
        slow = "sequence" in self.controllers or self.truth.model != "cwh"
        if slow and self.total > MAX_SLOW_CASES:
            raise ValueError(
                f"cases_per_cell: at most {MAX_SLOW_CASES} cases with sequence or two_body_j2, not {self.total}"
            )
        if self.truth.model != "cwh" and self.mean_motion_rad_s < 1e-4:
            raise ValueError("mean_motion_rad_s: at least 1e-4 for two_body_j2")
        return self

    @property
    def total(self) -> int:
        """Number of cases."""
        if self.distribution != "grid":
            return self.cases
        return len(self.omega_t_deg_s) * len(self.a_max_m_s2) * len(self.r0_m) * self.cases_per_cell

    @property
    def steps(self) -> int:
        """Control intervals of 2 s."""
        return round(self.horizon_s / DT_S)


class Rates95(WireModel):
    """Wilson intervals of 95 %, null without trials."""

    precision: list[float] | None
    recall: list[float] | None
    false_positive_rate: list[float] | None


class SweepConfusion(Confusion):
    """A certificate (positive: certified) against a controller (actual: flown without violation)."""

    false_positive_rate: float | None = Field(description="fp / (fp + tn).")
    false_positive_share: float | None = Field(description="fp / all, which Iskender et al. calls a rate.")
    wilson_95: Rates95


class DeltaV(WireModel):
    """Impulse of the flights without violation, m/s."""

    flights: int
    mean: float | None
    std: float | None
    least: float | None
    most: float | None


class Cell(WireModel):
    """One cell of Table 3."""

    a_max_m_s2: float
    omega_t_deg_s: float
    r0_m: float
    cases: int
    certified: dict[CertificateName, int] = Field(description="Certified starts by certificate.")
    feasible: dict[Controller, int] = Field(description="Flights without violation by controller.")


class CaseRecord(WireModel):
    """One start, as needed to fly it again."""

    case: int
    omega_t_deg_s: float
    a_max_m_s2: float
    x_m: float
    y_m: float
    margin_m: float | None = Field(description="Least face distance of the flight, or proved bound on it.")
    violated_at_s: float | None
    certified: dict[CertificateName, bool | None]


class SweepOutputs(WireModel):
    """Counts are sums over the shards in their order: the same for any number of workers."""

    cases: int
    evaluated: dict[str, int] = Field(description="Starts each certificate and controller was applied to.")
    undecided: int = Field(description="Starts whose exact answer is UNDECIDED: counted as not certified.")
    confusion: dict[str, dict[str, SweepConfusion]]
    delta_v_m_s: dict[str, DeltaV]
    control_steps: dict[str, int]
    fallbacks: dict[str, int] = Field(description="Steps at which a controller had no admissible command.")
    cells: list[Cell] = Field(description="Table 3; empty unless the distribution is a grid.")
    worst: dict[Controller, list[CaseRecord]] = Field(
        description="Flights that violated although certified, then those closest to it; trajectories.npz has them."
    )
    false_go: list[CaseRecord] = Field(
        description="Starts that the paper's conditions (or certified: never seen) certify and exact proves NO_GO; "
        "false_go_proof.json proves the worst."
    )
    false_go_count: int
    notes: list[str]
    run_s: float = Field(description="Seconds of all parts together.")


HERE = "safestart.processes.sweep"

_CASE = (
    Column("case", "case"),
    Column("tumble rate [deg/s]", "omega_t_deg_s"),
    Column("thrust [m/s²]", "a_max_m_s2"),
    Column("x [m]", "x_m"),
    Column("y [m]", "y_m"),
    Column("margin [m]", "margin_m"),
    Column("left after [s]", "violated_at_s"),
    Column("certified", "certified.certified"),
    Column("by the paper's conditions, not sound", "certified.paper"),
    Column("proved by exact", "certified.exact"),
)

SPEC = ProcessSpec(
    id="sweep",
    title="Closed-loop sweep",
    description=(
        "Flies many starts with the chosen controllers against a chosen truth, violations looked for at all times, and "
        "compares with the certificates: Table 3 layout, confusion matrices with intervals, impulse, worst cases. In "
        "parts; the result does not depend on the number of workers."
    ),
    inputs=SweepInputs,
    outputs=SweepOutputs,
    sharding=Sharding(
        split=f"{HERE}.split:split",
        shard=f"{HERE}.shard:shard",
        merge=f"{HERE}.merge:merge",
        summary=f"{HERE}.study:summary",
    ),
    views=(
        Matrices(
            "Each certificate against each controller",
            "Rows: the certificate's word on the start. Columns: whether this controller's flight stayed in the "
            "corridor. A flight that is lost from a start with a proof is the controller's failure, not a false "
            "proof. Intervals: Wilson, 95 %.",
            path="confusion.*.*",
            names=("", ""),
            heading="{0}, flown by {1}",
            claims=("certified", "not certified"),
            facts=("stayed", "left"),
            cells=(
                "certified, stayed",
                "certified, lost in flight",
                "stayed, not certified",
                "not certified, left",
            ),
        ),
        Facts(
            (
                Column("Starts", "cases"),
                Column("of which exact leaves undecided", "undecided"),
                Column("certified, most by the paper's conditions, and proved NO_GO", "false_go_count"),
            )
        ),
        Flights("Worst cases", "trajectories.npz", path="worst", columns=_CASE),
        Rows("Certified (by whom: see the columns) and proved NO_GO", "false_go", _CASE, explore=True),
        Rows(
            "Cells",
            "cells",
            (
                Column("tumble rate [deg/s]", "omega_t_deg_s"),
                Column("thrust [m/s²]", "a_max_m_s2"),
                Column("range [m]", "r0_m"),
                Column("starts", "cases"),
                Column("certified", "certified.certified"),
                Column("by the paper's conditions, not sound", "certified.paper"),
                Column("proved by exact", "certified.exact"),
                Column("stayed: filter", "feasible.filter"),
                Column("stayed: fine filter", "feasible.filter_fine"),
                Column("stayed: sequence", "feasible.sequence"),
            ),
        ),
    ),
    keywords=("closed loop", "Monte Carlo", "MPC", "confusion matrix"),
    example={"controllers": ["filter"], "cases_per_cell": 3, "omega_t_deg_s": [1, 3], "a_max_m_s2": [0.1]},
)
