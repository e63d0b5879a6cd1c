"""The scenario of a question in space: how the target turns, its orbit, the corridor and the thrust."""

from __future__ import annotations

from pydantic import Field

from safestart.model.scenario import MAX_ACCELERATION, MAX_MEAN_MOTION, MIN_ACCELERATION
from safestart.processes.base import WireModel
from safestart.processes.start_in_space.parts import (
    AttitudeInput,
    CorridorChoice,
    FiveFaces,
    OrbitInput,
    ThrustInput,
)


class SpaceScenario(WireModel):
    """Objects, or the numbers of the short form that stand for those left out."""

    attitude: AttitudeInput | None = Field(None, description="How the target turns; absent: omega_t_deg_s.")
    orbit: OrbitInput | None = Field(None, description="The target's orbit; absent: mean_motion_rad_s.")
    corridor: CorridorChoice = Field(
        default_factory=FiveFaces, description="What the chaser must stay inside of."
    )
    thrust: ThrustInput | None = Field(
        None, description="What thrust it can hold over 2 s; absent: a_max_m_s2."
    )
    omega_t_deg_s: float | None = Field(
        None,
        ge=-60,
        le=60,
        description="Spin about LVLH z from the axes of LVLH on, deg/s; instead of attitude.",
    )
    phase_deg: float | None = Field(
        None,
        ge=-36000,
        le=36000,
        description="With omega_t_deg_s: by how much the body is ahead at t = 0, deg. Absent: 0.",
    )
    a_max_m_s2: float | None = Field(
        None,
        ge=MIN_ACCELERATION,
        le=MAX_ACCELERATION,
        description="Ball of thrusts, m/s^2; instead of thrust.",
    )
    mean_motion_rad_s: float | None = Field(
        None, ge=0, le=MAX_MEAN_MOTION, description="Circular orbit, rad/s; instead of orbit. Default 1.1e-3."
    )
