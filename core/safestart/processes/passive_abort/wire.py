"""Errors, failures and burns as they appear on the wire; shared with the hopping process."""

from __future__ import annotations

import math
from typing import Annotated, Literal

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
    """An impulse, or a burn that lasts."""

    time_s: float = Field(ge=0, le=1e7, description="When it begins, s.")
    impulse_m_s: Three = Field(description="Change of velocity, LVLH, m/s.")
    duration_s: float = Field(
        0.0,
        ge=0,
        le=1e5,
        description="Time over which the impulse is spread evenly (its thrust is impulse_m_s / duration_s, LVLH); "
        "0: at once.",
    )


class ErrorsInput(WireModel):
    """What states and burns may be off by."""

    position_m: float = Field(
        0.5, ge=0, le=1e4, description="Half-width of the box of positions, m, each axis."
    )
    velocity_m_s: float = Field(1e-3, ge=0, le=100, description="Half-width of the box of velocities, m/s.")
    thrust_share: float = Field(0.01, ge=0, le=0.99, description="Relative error of a burn's size.")
    thrust_deg: float = Field(0.5, ge=0, le=90, description="Error of a burn's direction, deg.")
    covariance: list[list[float]] | None = Field(
        None,
        min_length=6,
        max_length=6,
        description="Of position and velocity, LVLH, m and m/s, 6 x 6: an ellipsoid of errors of ``sigmas`` standard "
        "deviations takes the place of the box.",
    )
    sigmas: float = Field(3.0, gt=0, le=100, description="Size of the ellipsoid.")
    at_each_burn: bool = Field(
        True,
        description="The box holds before every burn, as burns are planned anew; false: before the first one, and the "
        "errors of the burns add up.",
    )


class ZoneInput(WireModel):
    """A body that moves with LVLH."""

    kind: Literal["sphere", "ellipsoid", "box"]
    centre_m: Three = Field(default_factory=lambda: [0.0, 0.0, 0.0], description="LVLH, m.")
    half_m: Three = Field(
        description="Radius, three times (sphere), semi-axes (ellipsoid) or half-edges (box), m."
    )
    attitude_wxyz: Annotated[list[float], Field(min_length=4, max_length=4)] = Field(
        default_factory=lambda: [1.0, 0.0, 0.0, 0.0],
        description="Quaternion, scalar first, that turns LVLH coordinates into those of the body's axes.",
    )


class FailuresInput(WireModel):
    """What may happen to any one burn; none follows a failure. A missed burn is always asked for, and so is a burn that
    lasts and ends early, at any time."""

    late_s: float = Field(0.0, ge=0, le=1e4, description="Largest delay, s.")
    partial: bool = Field(False, description="Burnt in part, 0 to 100 %.")
    stuck_s: float = Field(0.0, ge=0, le=1e4, description="Longest time that a burn stays stuck on, s.")
    acceleration_m_s2: float = Field(
        0.0,
        ge=0,
        le=100,
        description="Thrust of an engine that is stuck on after an impulse, m/s^2; a burn that lasts has its own.",
    )
    misdirected_deg: float = Field(0.0, ge=0, le=180, description="Largest error of direction, deg.")


def radians(degrees: float) -> float:
    """Degrees as radians, at most pi."""
    return min(math.radians(degrees), math.pi)
