"""drift: where a chaser goes without thrust, and how close it comes to the target's centre."""

from __future__ import annotations

from pydantic import Field

from safestart.model.scenario import MAX_MEAN_MOTION
from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.views import Column, Facts
from safestart.processes.wire import Horizon, Triple


class DriftInputs(WireModel):
    """A state, LVLH, and how long to look."""

    position_m: list[float] = Field(min_length=3, max_length=3, description="LVLH, m.")
    velocity_m_s: list[float] = Field([0, 0, 0], min_length=3, max_length=3, description="LVLH, m/s.")
    mean_motion_rad_s: float = Field(1.1e-3, ge=0, le=MAX_MEAN_MOTION, description="Of the orbit, rad/s.")
    horizon_s: Horizon = Field(600.0, description="How long to drift, s.")


class DriftOutputs(WireModel):
    """A curve over ``time_s`` and its closest point."""

    time_s: list[float]
    position_m: list[Triple] = Field(description="LVLH, m.")
    closest_m: float = Field(description="Smallest distance to the target's centre.")
    closest_s: float = Field(description="When it is reached.")


SPEC = ProcessSpec(
    id="drift",
    title="Free drift",
    description="Where a chaser drifts without thrust, and how close it comes to the target's centre.",
    inputs=DriftInputs,
    outputs=DriftOutputs,
    run="safestart.processes.drift.run:run",
    light=True,
    tables=(Table("drift", ("time_s", "position_m")),),
    views=(Facts((Column("Closest [m]", "closest_m"), Column("after [s]", "closest_s"))),),
    keywords=("drift",),
    example={"position_m": [0, 100, 0], "velocity_m_s": [0, -0.2, 0]},
)
