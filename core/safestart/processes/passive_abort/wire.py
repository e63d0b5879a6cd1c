"""Errors, failures and burns as they appear on the wire; shared with the hopping process."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from safestart.processes.base import WireModel

Three = Annotated[list[float], Field(min_length=3, max_length=3)]
SemiMajorAxis = Annotated[
    float,
    Field(ge=6_378_137.0, le=1e8, description="Radius of the target's circular orbit, m.", examples=[8.1e6]),
]
KeepOut = Annotated[float, Field(gt=0, le=1e5, description="Radius around the target to keep out of, m.")]
Orbits = Annotated[float, Field(gt=0, le=20, description="How many orbits the drift is followed.")]


class AbortStartInput(WireModel):
    """A state in LVLH: x radial, y along-track, z cross-track."""

    position_m: Three = Field(description="LVLH position, m.")
    velocity_m_s: Three = Field(description="LVLH velocity, m/s.")


class BurnInput(WireModel):
    """An impulse."""

    time_s: float = Field(ge=0, le=1e7, description="When, s.")
    impulse_m_s: Three = Field(description="Change of velocity, LVLH, m/s.")


class ErrorsInput(WireModel):
    """What states and burns may be off by."""

    position_m: float = Field(
        0.5, ge=0, le=1e4, description="Half-width of the box of positions, m, each axis."
    )
    velocity_m_s: float = Field(1e-3, ge=0, le=100, description="Half-width of the box of velocities, m/s.")
    thrust_share: float = Field(0.01, ge=0, le=0.99, description="Relative error of a burn's size.")
    thrust_deg: float = Field(0.5, ge=0, le=90, description="Error of a burn's direction, deg.")
    at_each_burn: bool = Field(
        True,
        description="The box holds before every burn, as burns are planned anew; false: before the first one, and the "
        "errors of the burns add up.",
    )


class FailuresInput(WireModel):
    """What may happen to any one burn; none follows a failure. A missed burn is always asked for."""

    late_s: float = Field(0.0, ge=0, le=1e4, description="Largest delay, s.")
    partial: bool = Field(False, description="Burnt in part, 0 to 100 %.")
    stuck_s: float = Field(0.0, ge=0, le=1e4, description="Longest time that a burn stays stuck on, s.")
    acceleration_m_s2: float = Field(
        0.0, ge=0, le=100, description="Thrust of an engine that is stuck on, m/s^2."
    )
    misdirected_deg: float = Field(0.0, ge=0, le=180, description="Largest error of direction, deg.")


def radians(degrees: float) -> float:
    """Degrees as radians, at most pi."""
    return min(math.radians(degrees), math.pi)
