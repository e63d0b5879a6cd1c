"""Models shared by the processes: the scenario and the grid as they appear on the wire, units in the names."""

from __future__ import annotations

import math
from typing import Annotated, TypeVar

from pydantic import AfterValidator, Field

from safestart.closed_form.by_name import ClosedForm
from safestart.model.scenario import (
    MAX_ACCELERATION,
    MAX_MEAN_MOTION,
    MAX_RANGE,
    MIN_ACCELERATION,
    Chaser,
    CorridorShape,
    Grid,
    Scenario,
    Target,
)
from safestart.processes.base import WireModel

Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
Triple = Annotated[list[float], Field(min_length=3, max_length=3)]
PlanarOrSolid = Annotated[list[float], Field(min_length=2, max_length=3)]
"""Outputs of a bounded length are columns of their own in tables."""
TumbleRate = Annotated[
    float,
    Field(ge=0.0, le=60.0, description="Tumble rate of the target about LVLH z, deg/s.", examples=[3.0]),
]
Thrust = Annotated[
    float,
    Field(
        ge=MIN_ACCELERATION,
        le=MAX_ACCELERATION,
        description="Maximum thrust acceleration of the chaser, m/s^2.",
        examples=[0.1],
    ),
]
DT_S = 2.0
"""Length of a control interval, s."""
LONGEST_S = 600
"""Longest horizon of a question, s."""
Horizon = Annotated[float, Field(ge=DT_S, le=LONGEST_S, multiple_of=DT_S)]
T = TypeVar("T")


def _distinct(values: list[T]) -> list[T]:
    if len(set(values)) != len(values):
        raise ValueError("each value at most once")
    return values


DISTINCT = AfterValidator(_distinct)
"""For a list without repeated names."""
Certificate = Annotated[
    ClosedForm,
    Field(
        description="certified: explicit manoeuvres with a proof, GO is for ever. paper: the conditions of Iskender et "
        "al., NOT SOUND, a GO may be impossible to fly."
    ),
]
Seed = Annotated[int, Field(ge=0, le=2**63 - 1, description="Seed of every random draw.")]


class CorridorInput(WireModel):
    """Line-of-sight corridor (Iskender et al., eq. 4); the defaults are the paper's."""

    c_x: float = Field(1.5, gt=0, le=100, description="Slope of the +-x sides.")
    c_z: float = Field(1.5, gt=0, le=100, description="Slope of the +-z sides.")
    x0_m: float = Field(2.5, ge=0, le=1000, description="Half-width of the port in x, m.")
    z0_m: float = Field(2.5, ge=0, le=1000, description="Half-width of the port in z, m.")
    r_h_m: float = Field(0.5, ge=0, le=1000, description="Hold stand-off radius, m.")

    def shape(self) -> CorridorShape:
        """The corridor in the core's terms."""
        return CorridorShape(self.c_x, self.c_z, self.x0_m, self.z0_m, self.r_h_m)


class GridInput(WireModel):
    """Body-frame grid: linspace over x in +-(x0 + c_x (y_max - r_h)) and y in [0, y_max], masks ``[iy][ix]``."""

    nx: int = Field(31, ge=2, le=1000, description="Points across.")
    ny: int = Field(31, ge=2, le=1000, description="Points along.")
    y_max_m: float = Field(150.0, gt=0, le=MAX_RANGE, description="Where the corridor is cut, m.")

    def grid(self) -> Grid:
        """The grid in the core's terms."""
        return Grid(self.nx, self.ny, self.y_max_m)


class ScenarioInput(WireModel):
    """Target, chaser and corridor of one question."""

    omega_t_deg_s: TumbleRate
    a_max_m_s2: Thrust
    mean_motion_rad_s: float = Field(
        1.1e-3, ge=0, le=MAX_MEAN_MOTION, description="Mean motion of the target's orbit, rad/s."
    )
    corridor: CorridorInput = Field(default_factory=CorridorInput)

    def scenario(self) -> Scenario:
        """The scenario in SI units."""
        target = Target(math.radians(self.omega_t_deg_s), self.mean_motion_rad_s)
        return Scenario(target, Chaser(self.a_max_m_s2), self.corridor.shape())


class Confusion(WireModel):
    """A certificate (positive: certified) against the truth (actual); shares without a case are null."""

    tp: int
    fp: int
    fn: int
    tn: int
    precision: float | None
    recall: float | None
    accuracy: float | None
    f1: float | None
    mcc: float | None


def finite(value: float) -> float | None:
    """A float for JSON: None instead of infinity or NaN."""
    return float(value) if math.isfinite(value) else None


NO_SYNC_LIMIT = "the target does not tumble, so no range limits synchronization (infinite)"
