"""coverage: safe fraction of the corridor over tumble rates and thrust levels (paper 000, Table 1, Fig. 3)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from safestart.model.scenario import MAX_MEAN_MOTION
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.views import Column, Rows
from safestart.processes.wire import Certificate, CorridorInput, GridInput, Thrust, TumbleRate

Rates = Annotated[list[TumbleRate], Field(min_length=1, max_length=50)]
Thrusts = Annotated[list[Thrust], Field(min_length=1, max_length=50)]


class CoverageInputs(WireModel):
    """Lists of tumble rates and thrust levels; every pair is evaluated."""

    omega_t_deg_s: Rates = Field([1.0, 2.0, 3.0, 4.0, 5.0], description="Tumble rates, deg/s.")
    a_max_m_s2: Thrusts = Field([0.20, 0.10, 0.05, 0.01], description="Thrust accelerations, m/s^2.")
    grid: GridInput = Field(default_factory=lambda: GridInput(nx=401, ny=401, y_max_m=150.0))
    mean_motion_rad_s: float = Field(1.1e-3, ge=0, le=MAX_MEAN_MOTION, description="Mean motion, rad/s.")
    corridor: CorridorInput = Field(default_factory=CorridorInput)
    certificate: Certificate = "certified"


class CoverageCell(WireModel):
    """One pair."""

    omega_t_deg_s: float
    a_max_m_s2: float
    safe_percent: float = Field(description="Certified share of the corridor, percent.")
    paper_percent: float = Field(
        description="Share by the paper's conditions, which are not sound, percent: Table 1."
    )
    r_sync_m: float | None = Field(description="The paper's synchronization range limit, m.")


class CoverageOutputs(WireModel):
    """One cell per pair, tumble rates outermost."""

    cells: list[CoverageCell]


SPEC = ProcessSpec(
    id="coverage",
    title="Coverage of the corridor by the certificate",
    description="Safe percentage of the line-of-sight corridor for each pair of tumble rate and thrust, with a map.",
    inputs=CoverageInputs,
    outputs=CoverageOutputs,
    run="safestart.processes.coverage.run:run",
    views=(
        Rows(
            "Certified share of the corridor",
            "cells",
            (
                Column("tumble rate [deg/s]", "omega_t_deg_s"),
                Column("thrust [m/s²]", "a_max_m_s2"),
                Column("certified [%]", "safe_percent"),
                Column("by the paper's conditions, not sound [%]", "paper_percent"),
                Column("synchronization radius of the paper [m]", "r_sync_m"),
            ),
        ),
    ),
    keywords=("certificate", "trade study"),
    example={
        "omega_t_deg_s": [1, 3, 5],
        "a_max_m_s2": [0.1, 0.05],
        "grid": {"nx": 401, "ny": 401, "y_max_m": 150},
    },
)
