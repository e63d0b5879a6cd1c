"""trade-study: safe fraction, exact area, closed-loop success and impulse over tumble rate and thrust."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, field_validator

from safestart.model.scenario import MAX_MEAN_MOTION
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.sharding import Sharding
from safestart.processes.sweep.inputs import Rates, Thrusts
from safestart.processes.views import Column, Facts, Rows
from safestart.processes.wire import Certificate, CorridorInput, GridInput, Horizon, Seed


class TradeStudyInputs(WireModel):
    """Every pair of tumble rate and thrust is one operating point."""

    omega_t_deg_s: Rates = Field([1.0, 2.0, 3.0, 4.0, 5.0], description="Tumble rates, deg/s.")
    a_max_m_s2: Thrusts = Field([0.02, 0.05, 0.10, 0.15, 0.20], description="Thrust accelerations, m/s^2.")
    grid: GridInput = Field(default_factory=GridInput)
    horizon_s: Horizon = Field(60.0, description="Flight time, s; a multiple of 2 s.")
    preset: Literal["tuned", "paper"] = Field("tuned", description="Gains of the filter.")
    mean_motion_rad_s: float = Field(1.1e-3, ge=0, le=MAX_MEAN_MOTION, description="Mean motion, rad/s.")
    corridor: CorridorInput = Field(default_factory=CorridorInput)
    certificate: Certificate = "certified"
    seed: Seed = 0

    @field_validator("omega_t_deg_s", "a_max_m_s2")
    @classmethod
    def _ordered(cls, value: list[float]) -> list[float]:
        return sorted(value)

    @field_validator("grid")
    @classmethod
    def _affordable(cls, value: GridInput) -> GridInput:
        if value.nx * value.ny > 40_401:
            raise ValueError("nx * ny at most 40401 (201 x 201)")
        return value


class TradePoint(WireModel):
    """One operating point; fractions are of the corridor's grid points."""

    omega_t_deg_s: float
    a_max_m_s2: float
    certified_fraction: float = Field(description="By the requested closed form.")
    paper_fraction: float = Field(description="By the paper's conditions, which are not sound.")
    exact_inner_m2: float = Field(description="Area proved GO: some thrust history stays for horizon_s.")
    exact_outer_m2: float = Field(description="Area outside of which NO_GO is proved.")
    exact_fraction: float | None = Field(
        description="Proved GO share of the corridor's area; null where the atlas stopped early."
    )
    flown_fraction: float = Field(description="Flown by the filter without violation, checked at all times.")
    certified_flown: float | None = Field(
        description="Share of the certified points that were flown: precision."
    )
    mean_delta_v_m_s: float | None = Field(description="Mean impulse of the flights without violation.")
    message: str


class TradeStudyOutputs(WireModel):
    """Points by thrust, then tumble rate."""

    corridor_points: int
    corridor_area_m2: float
    points: list[TradePoint]


SPEC = ProcessSpec(
    id="trade-study",
    title="Trade study over tumble rate and thrust",
    description=(
        "For every pair of tumble rate and thrust: certified share of the corridor, area proved by the exact answer, "
        "share flown by the filter, impulse. Starts at rest in LVLH on a grid. Heat maps; a part per operating point."
    ),
    inputs=TradeStudyInputs,
    outputs=TradeStudyOutputs,
    kernels=("flights", "exact answers"),
    sharding=Sharding.of("safestart.processes.trade_study"),
    views=(
        Facts(
            (
                Column("Starts per point", "corridor_points"),
                Column("Area of the corridor [m²]", "corridor_area_m2"),
            )
        ),
        Rows(
            "Operating points",
            "points",
            (
                Column("tumble rate [deg/s]", "omega_t_deg_s"),
                Column("thrust [m/s²]", "a_max_m_s2"),
                Column("certified share", "certified_fraction"),
                Column("by the paper's conditions, not sound", "paper_fraction"),
                Column("proved GO share", "exact_fraction"),
                Column("flown share", "flown_fraction"),
                Column("certified starts flown", "certified_flown"),
                Column("mean delta-v [m/s]", "mean_delta_v_m_s"),
                Column("message", "message"),
            ),
        ),
    ),
    keywords=("trade study", "closed loop", "coverage"),
    example={"omega_t_deg_s": [1, 3, 5], "a_max_m_s2": [0.05, 0.1], "grid": {"nx": 21, "ny": 21}},
)
