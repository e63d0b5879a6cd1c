"""start-in-space: may a chaser that arrives like this start its approach to a target that tumbles like that?"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from safestart.engines.tracking_options import TrackingSettings
from safestart.papers.envisat import TUMBLING
from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.costs import FIRST_S, program_s
from safestart.processes.go_no_go.question_fields import QuestionKind
from safestart.processes.start_in_space.demand_parts import FieldOfViewInput, KeepOutInput, PlumeInput
from safestart.processes.start_in_space.flight_output import SpaceFlight, Turning
from safestart.processes.start_in_space.missions import MISSIONS
from safestart.processes.start_in_space.parts import (
    SpaceStart,
    Vector,
)
from safestart.processes.start_in_space.space_scenario import SpaceScenario
from safestart.processes.tracking_mpc.controller_input import TrackingAnswer
from safestart.processes.views import Column, Facts, Findings, Layer, Picture
from safestart.processes.wire import Horizon, Triple

MOST_STARTS = 1000
MOST_PROOFS = 100
UNKNOWNS = ("attitude_half_angle_deg", "body_rate_half_width_deg_s", "inertia_half_width", "disturbance_m_s2")
"""What may not be known beside the start."""
Method = Literal["exact", "auto", "tracking"]
DECIDED_BY = (
    "What decided: exact (a cone program, proved for the horizon), families (one for the whole box of starts or every "
    "member of what is not known), tracking (flown, proved, certified); null when UNDECIDED."
)


class _Starts(WireModel):
    """Stands last among the bases, so that the starts are the first field."""

    starts: list[SpaceStart] = Field(min_length=1, max_length=MOST_STARTS, description="States at t = 0.")


class SpaceInputs(SpaceScenario, _Starts):
    """One question in space and up to 1 000 starts; numbers of the short form stand for the objects left out."""

    method: Method = Field(
        "exact",
        description="exact, auto: cone programs, proved either way. tracking: the tracking MPC of Rebollo et al. flown "
        "to rest at the port, its thrust history proved and its plans certified; beside it the exact answer, which "
        "decides NO_GO. For five faces, a circular orbit, a spin or a torque-free body, a ball or a box of thrusts.",
    )
    tracking: TrackingSettings | None = Field(
        None, description="Settings of the tracking MPC (method tracking); absent: their defaults."
    )
    question: QuestionKind = Field(
        "stay",
        description="stay: inside all faces at all times of horizon_s. synchronize: in addition at rest against the "
        "turning body inside a ball around the hold point at the end, at some time up to within_s; what comes after is "
        "not asked.",
    )
    horizon_s: Horizon = Field(60.0, description="How long to stay, s.")
    within_s: Horizon = Field(
        200.0, description="Latest end of synchronize, and latest arrival of the tracking MPC, s."
    )
    hold_m: Vector | None = Field(
        None,
        description="Hold point, body frame, m; absent: on the axis of the five faces, at the hold radius.",
    )
    ball_radius_m: float = Field(0.5, ge=0.001, le=1000, description="Ball around the hold point, m.")
    rest_speed_m_s: float = Field(
        0.05,
        ge=1e-4,
        le=100,
        description="Largest speed against the turning body that counts as at rest, m/s.",
    )
    speed_limit_m_s: float | None = Field(
        None, ge=0.001, le=1000, description="Largest LVLH speed at all times, m/s; absent: none."
    )
    position_half_width_m: float = Field(
        0.0,
        ge=0,
        le=1000,
        description="Half-width of a box of starts along the LVLH axes, m (stay): GO is one thrust history for all of "
        "them, NO_GO none for any.",
    )
    velocity_half_width_m_s: float = Field(
        0.0, ge=0, le=10, description="Half-width of the box in velocity, m/s (stay)."
    )
    attitude_half_angle_deg: float = Field(
        0.0,
        ge=0,
        le=30,
        description="The attitude at t = 0 is within this angle of the one given, deg (stay). For this and the next "
        "three GO is one thrust history for all, by a bound on how far the attitude and the chaser may be off; NO_GO "
        "holds for what is given; else UNDECIDED. Starts in body axes are taken to LVLH by the attitude given.",
    )
    body_rate_half_width_deg_s: float = Field(
        0.0,
        ge=0,
        le=5,
        description="The angular velocity differs by at most this, deg/s: at t = 0 of a torque-free body, at all times "
        "of a spin or a table (stay).",
    )
    inertia_half_width: float = Field(
        0.0,
        ge=0,
        le=0.3,
        description="Each moment about the body's axes (diagonal of inertia_kg_m2) differs by at most this share "
        "(stay, torque_free).",
    )
    disturbance_m_s2: float = Field(
        0.0,
        ge=0,
        le=1,
        description="Any acceleration of the chaser up to this acts beside the thrust, m/s^2 (stay); no feedback is "
        "assumed.",
    )
    keep_outs: list[KeepOutInput] = Field(
        default_factory=list,
        max_length=8,
        description="Spheres and boxes that the chaser stays out of, beside the corridor. For keep_outs, field_of_view "
        "and plume GO is found in a convex part of the demand that restriction names, and its proof shows the demand "
        "itself; NO_GO only without them, from the start, or by planes around the view's cone; else UNDECIDED. Not "
        "with half-widths or method tracking.",
    )
    field_of_view: FieldOfViewInput | None = Field(
        None, description="A cone about a camera's axis in which the target stays; absent: none."
    )
    plume: PlumeInput | None = Field(
        None, description="No exhaust towards the target near it, for thrust of kind ball; absent: none."
    )
    flights: bool = Field(
        False,
        description="Return the flight of every GO as curves, and how the target turns; at most 100 starts.",
    )
    proofs: bool = Field(
        False, description="Return proof documents for `safestart verify`; at most 100 starts."
    )

    @property
    def uncertain(self) -> bool:
        """Whether more than the start is not known."""
        return any(getattr(self, name) > 0.0 for name in UNKNOWNS)

    @model_validator(mode="after")
    def _settings_of_its_method(self) -> SpaceInputs:
        if self.tracking is not None and self.method != "tracking":
            raise ValueError(f"tracking: only with method tracking, received {self.method}")
        return self


class SpaceOutputs(WireModel):
    """Arrays over the starts, in their order; margins in metres."""

    method: Method
    question: QuestionKind
    faces: list[str] = Field(description="Names of the faces.")
    verdict: list[Literal["GO", "NO_GO", "UNDECIDED"]]
    decided_by: list[str | None] = Field(description=DECIDED_BY)
    margin_m: list[float | None] = Field(
        description="Proved bound on the margin (distance to every face; limits in metres, see docs), m: from below "
        "for GO, from above for NO_GO, null when UNDECIDED."
    )
    model_error_m: list[float] = Field(
        description="Estimate of what two bodies with J2 would change over the horizon, m; where it exceeds the "
        "margin, the reason says so."
    )
    violated_faces: list[list[str]] = Field(
        description="Faces, keep-outs and field of view that the start violates."
    )
    position_m: list[Triple] = Field(description="Starts, LVLH, m.")
    velocity_m_s: list[Triple] = Field(description="Starts, LVLH, m/s.")
    reason: list[str] = Field(description="The verdict in a sentence.")
    end_s: list[float | None] | None = Field(
        None,
        description="When the flight of a GO is at rest in the hold ball (synchronize), s; null for the others.",
    )
    restriction: list[list[str]] | None = Field(
        None,
        description="With keep_outs, field_of_view or plume: the convex part of each by which a GO was found; empty "
        "for the others.",
    )
    flight: list[SpaceFlight | None] | None = Field(
        None, description="The flights of the GOs, when asked for; null for the others."
    )
    turning: Turning | None = Field(
        None, description="How the target turns, where flights are asked for: whatever the verdicts."
    )
    tracking: list[TrackingAnswer] | None = Field(
        None, description="Method tracking: the controller's flight from each start, beside the exact answer."
    )
    proof: list[dict[str, Any] | None] | None = Field(
        None, description="Proof documents for `safestart verify`, when asked for; null for UNDECIDED."
    )


_FLIGHT_S = 1.0


def _cost(inputs: SpaceInputs) -> float:
    synchronize = inputs.question == "synchronize"
    one = 3.0 * program_s(inputs.within_s if synchronize else inputs.horizon_s)
    if inputs.position_half_width_m or inputs.velocity_half_width_m_s:
        one *= 10.0
    if inputs.uncertain:
        one *= 5.0
    if inputs.keep_outs or inputs.field_of_view or inputs.plume:
        one *= 6.0
    flight = _FLIGHT_S if inputs.method == "tracking" else 0.0
    return FIRST_S + ((4.0 if synchronize else 1.0) * one + flight) * len(inputs.starts)


SPEC = ProcessSpec(
    id="start-in-space",
    title="Go/no-go for any start, tumble, orbit and corridor",
    description=(
        "Whether any thrust history keeps the chaser inside the faces at all times of the horizon, and brings it to "
        "rest against the turning body at the end where asked to: proved either way "
        "for any start, a spin, a torque-free body or a table of attitudes, a circular or an elliptic orbit, faces in "
        "the body frame or LVLH, and thrust from a ball, a box or thrusters. The motion is linear in the distance."
    ),
    inputs=SpaceInputs,
    outputs=SpaceOutputs,
    kernels=("exact answers",),
    run="safestart.processes.start_in_space.run:run",
    light=True,
    cost=_cost,
    states="starts",
    tables=(
        Table(
            "starts",
            (
                "verdict",
                "decided_by",
                "margin_m",
                "model_error_m",
                "position_m",
                "velocity_m_s",
                "violated_faces",
                "reason",
                "restriction",
                "end_s",
                "tracking",
            ),
        ),
    ),
    views=(
        Findings(
            "Verdicts",
            "starts",
            word="verdict",
            columns=(
                Column("margin [m]", "margin_m"),
                Column("error of the model [m]", "model_error_m"),
                Column("decided by", "decided_by"),
                Column("why", "reason"),
                Column("faces violated at the start", "violated_faces"),
                Column("found in", "restriction"),
                Column("at rest after [s]", "end_s"),
            ),
        ),
        Facts((Column("Method", "method"), Column("Question", "question"), Column("Faces", "faces"))),
        Picture(
            "Starts",
            "x [m], in the start's frame",
            "y [m], in the start's frame",
            (
                Layer(
                    "start",
                    "points",
                    "starts",
                    "starts.position_m.0",
                    "starts.position_m.1",
                    value="verdict",
                    beside="starts",
                ),
            ),
            equal=True,
        ),
    ),
    keywords=("certificate", "go/no-go", "torque-free", "elliptic orbit"),
    extensions={"safestart:examples": MISSIONS},
    example={
        "starts": [{"position_m": [2, 25, 1], "velocity_m_s": [0, 0, 0], "frame": "body"}],
        "attitude": TUMBLING,
        "orbit": {"mean_motion_rad_s": 0.00105},
        "thrust": {"kind": "ball", "a_max_m_s2": 0.1},
    },
)
