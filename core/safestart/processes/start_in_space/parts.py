"""The parts of a question in space as they appear on the wire: start, attitude, orbit, corridor, thrust."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from safestart.model.scenario import MAX_ACCELERATION, MAX_MEAN_MOTION, MIN_ACCELERATION
from safestart.processes.base import WireModel
from safestart.processes.wire import CorridorInput

MOST_FACES = MOST_THRUSTERS = 32
MOST_ENTRIES = 20_000
Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]
Position = Annotated[list[Annotated[float, Field(ge=-10_000, le=10_000)]], Field(min_length=3, max_length=3)]
Velocity = Annotated[list[Annotated[float, Field(ge=-1000, le=1000)]], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[Number], Field(min_length=4, max_length=4)]
Frame = Literal["lvlh", "body"]
Reference = Literal["inertial", "lvlh"]
_WXYZ = "Quaternion, scalar first: r_B = C r_L with C = (s^2 - v.v) I + 2 v v^T - 2 s [v]x. Scaled to unit length."


class SpaceStart(WireModel):
    """Position and velocity at t = 0."""

    position_m: Position = Field(description="Position, m.")
    velocity_m_s: Velocity = Field(
        default_factory=lambda: [0.0, 0.0, 0.0],
        description="Velocity, m/s; with frame body against the turning body, in its axes. Absent: at rest in frame.",
    )
    frame: Frame = Field("lvlh", description="Axes, and what the velocity is against, at t = 0.")


class SpinAttitude(WireModel):
    """A steady spin about a fixed axis."""

    kind: Literal["spin"]
    axis: Vector = Field(
        default_factory=lambda: [0.0, 0.0, 1.0], description="Axis; its length does not matter."
    )
    axis_frame: Reference = Field(
        "lvlh",
        description="What the axis is fixed in and the spin is against; inertial axes are those of LVLH at t = 0.",
    )
    rate_deg_s: float = Field(ge=-60, le=60, description="Rate about the axis, deg/s; either sign.")
    phase_deg: float = Field(
        0.0, ge=-36000, le=36000, description="By how much the body is ahead at t = 0, deg."
    )


class TorqueFreeAttitude(WireModel):
    """A rigid body without torque (Euler-Poinsot)."""

    kind: Literal["torque_free"]
    inertia_kg_m2: list[Vector] = Field(min_length=3, max_length=3, description="Inertia tensor, body axes.")
    attitude_wxyz: Quaternion = Field(
        default_factory=lambda: [1.0, 0.0, 0.0, 0.0], description=f"LVLH to body at t = 0. {_WXYZ}"
    )
    body_rate_deg_s: Vector = Field(description="Angular velocity at t = 0, body axes, deg/s.")
    reference: Reference = Field(
        "inertial",
        description="What the rate is against: inertial axes, or LVLH, which turns, at t = 0. Not tracking-mpc's lvlh, "
        "which takes LVLH as inertial.",
    )


class TableAttitude(WireModel):
    """Quaternions at times, joined by slerp; the answer is about this interpolated course."""

    kind: Literal["table"]
    times_s: list[Number] = Field(
        min_length=2, max_length=MOST_ENTRIES, description="Rising, from 0 or before to the horizon, s."
    )
    attitude_wxyz: list[Quaternion] = Field(
        min_length=2, max_length=MOST_ENTRIES, description=f"From reference to body. {_WXYZ}"
    )
    reference: Reference = Field(
        "lvlh", description="What the quaternions lead from; inertial axes are those of LVLH at t = 0."
    )


AttitudeInput = Annotated[SpinAttitude | TorqueFreeAttitude | TableAttitude, Field(discriminator="kind")]


class CircularOrbit(WireModel):
    """A circular orbit."""

    mean_motion_rad_s: float = Field(
        ge=0, le=MAX_MEAN_MOTION, description="Mean motion, rad/s; 0: no gravity."
    )


class EllipticOrbit(WireModel):
    """An elliptic orbit about the Earth."""

    semi_major_axis_m: float = Field(ge=6_378_137, le=1e9, description="Semi-major axis, m.")
    eccentricity: float = Field(ge=0, le=0.8, description="Eccentricity; the perigee lies outside the Earth.")
    true_anomaly_deg: float = Field(0.0, ge=-36000, le=36000, description="True anomaly at t = 0, deg.")


def has(name: str, present: str, absent: str) -> Discriminator:
    """Tell two types apart by the field ``name`` that only one of them has."""

    def kind(value: Any) -> str:
        return present if (name in value if isinstance(value, dict) else hasattr(value, name)) else absent

    return Discriminator(kind)


OrbitInput = Annotated[
    Annotated[EllipticOrbit, Tag("elliptic")] | Annotated[CircularOrbit, Tag("circular")],
    has("semi_major_axis_m", "elliptic", "circular"),
]


class FiveFaces(CorridorInput):
    """The paper's five faces along any axis of the body."""

    axis: Vector = Field(
        default_factory=lambda: [0.0, 1.0, 0.0],
        description="Where the corridor opens, body frame; the cone is turned there from +y by the shortest way.",
    )


class FaceInput(WireModel):
    """A half-space."""

    name: str = Field(
        min_length=1,
        max_length=40,
        description="Name, each once; not field_of_view, hold, plume, rest, speed.",
    )
    normal: Vector = Field(
        description="normal . p <= offset_m for positions p; its length scales the offset."
    )
    offset_m: Number = Field(description="Offset, m for a unit normal.")
    frame: Frame = Field("body", description="Axes in which the face is fixed.")


class Faces(WireModel):
    """Any polyhedra, fixed in the body, in LVLH, or in both."""

    faces: list[FaceInput] = Field(min_length=1, max_length=MOST_FACES, description="Half-spaces.")


CorridorChoice = Annotated[
    Annotated[Faces, Tag("faces")] | Annotated[FiveFaces, Tag("five")], has("faces", "faces", "five")
]
Acceleration = Annotated[float, Field(ge=0, le=MAX_ACCELERATION)]


class BallThrust(WireModel):
    """The same limit in every direction."""

    kind: Literal["ball"]
    a_max_m_s2: float = Field(ge=MIN_ACCELERATION, le=MAX_ACCELERATION, description="Largest size, m/s^2.")


class BoxThrust(WireModel):
    """Each axis by itself."""

    kind: Literal["box"]
    a_max_m_s2: list[Acceleration] = Field(min_length=3, max_length=3, description="Largest per axis, m/s^2.")
    frame: Frame = Field(
        "lvlh",
        description="Axes; body: as it is turned at the begin of each step of 2 s. Thrust is held in LVLH.",
    )


class ThrustersInput(WireModel):
    """The hull of 0 and the thrusts of some thrusters: shares that sum to at most 1."""

    kind: Literal["thrusters"]
    directions: list[Vector] = Field(
        min_length=3,
        max_length=MOST_THRUSTERS,
        description="Directions of the thrusts; lengths do not matter.",
    )
    a_max_m_s2: list[Acceleration] = Field(
        min_length=3, max_length=MOST_THRUSTERS, description="Largest of each, m/s^2."
    )
    frame: Frame = Field("lvlh", description="Axes, as for a box.")


ThrustInput = Annotated[BallThrust | BoxThrust | ThrustersInput, Field(discriminator="kind")]
