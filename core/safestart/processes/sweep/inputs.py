"""What a sweep is asked: controllers, certificates, starts and the flown world."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from safestart.dynamics.registry import CWH, MOTIONS, MotionName
from safestart.dynamics.registry import TEXTS as MOTION_TEXTS
from safestart.model.scenario import MAX_MEAN_MOTION, MAX_RANGE
from safestart.model.wire_model import WireModel
from safestart.processes.sweep.controllers import CONTROLLERS, TEXTS, Controller, slow
from safestart.processes.wire import DISTINCT, DT_S, CorridorInput, Horizon, Seed, Thrust, TumbleRate

CertificateName = Literal["certified", "paper", "exact"]
RENAMED = {"closed_form": "paper"}
"""Deprecated names of certificates, still taken."""


def _by_present_name(names: Any) -> Any:
    return [RENAMED.get(name, name) for name in names] if isinstance(names, list) else names


MAX_CASES = 1_000_000_000
_SLOW = " or ".join(
    [name for name in CONTROLLERS if slow([name])] + [name for name in MOTIONS if name != CWH]
)
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

    model: MotionName = Field(CWH, description=f"{MOTION_TEXTS}.")
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
        max_length=len(CONTROLLERS),
        description=f"{TEXTS}.",
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
        if self.one_by_one and self.total > MAX_SLOW_CASES:
            raise ValueError(f"cases_per_cell: at most {MAX_SLOW_CASES} cases with {_SLOW}, not {self.total}")
        motion = MOTIONS[self.truth.model]
        if not motion.takes(self.mean_motion_rad_s):
            raise ValueError(f"mean_motion_rad_s: {motion.required}")
        return self

    @property
    def total(self) -> int:
        """Number of cases."""
        if self.distribution != "grid":
            return self.cases
        return len(self.omega_t_deg_s) * len(self.a_max_m_s2) * len(self.r0_m) * self.cases_per_cell

    @property
    def one_by_one(self) -> bool:
        """Whether starts are flown one after another, in Python."""
        return slow(self.controllers) or self.truth.model != CWH

    @property
    def steps(self) -> int:
        """Control intervals of 2 s."""
        return round(self.horizon_s / DT_S)
