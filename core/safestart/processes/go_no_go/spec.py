"""go-no-go: may a chaser at rest at this point start its approach?"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field
from pydantic.dataclasses import dataclass

from safestart.model.scenario import MAX_RANGE, Rest
from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.go_no_go.cost import cost
from safestart.processes.go_no_go.method_registry import UNPROVED, MethodName
from safestart.processes.go_no_go.question_fields import QuestionFields, QuestionKind
from safestart.processes.go_no_go.uncertainty import Member
from safestart.processes.tracking_mpc.controller_input import TrackingAnswer
from safestart.processes.views import Column, Facts, Findings, Layer, Picture
from safestart.processes.wire import ScenarioInput

MAX_STATES = 100_000
DECIDED_BY = (
    "What decided: certified (the theorem of docs/theory/certified.md: for ever), exact or atlas (proved for "
    "horizon_s), families (half-widths), tube (disturbance), tracking (flown, proved, certified), paper (not sound); "
    "null when UNDECIDED."
)

HOLD_AFTER = "With after_arrival hold: what keeps the chaser after its end; null for NO_GO. Else absent."


# A dataclass with slots: 100 000 of them take a quarter of the memory of models.
@dataclass(config=ConfigDict(extra="forbid", allow_inf_nan=False), frozen=True, slots=True, kw_only=True)
class StateInput:
    """A start at rest: body-frame position in metres."""

    x_m: float = Field(ge=-MAX_RANGE, le=MAX_RANGE, description="Body-frame x, m.", examples=[5.0])
    y_m: float = Field(
        ge=-MAX_RANGE, le=MAX_RANGE, description="Body-frame y, along the corridor, m.", examples=[40.0]
    )
    z_m: float | None = Field(
        None, ge=-MAX_RANGE, le=MAX_RANGE, description="Body-frame z, m; absent: the planar question."
    )


class GoNoGoInputs(ScenarioInput, QuestionFields):
    """One operating point and up to 100 000 starts."""

    states: list[StateInput] = Field(min_length=1, max_length=MAX_STATES, description="Starts at rest.")
    rest: Rest = Field(Rest.LVLH, description="Frame in which the starts are at rest.")


class HoldAfter(WireModel):
    """What an LQR keeps for ever after the end of synchronize: thrust = reference + gain error, held over 2 s.

    The reference is at ``point_m`` of the body frame at every step; every error (x, y, vx, vy, LVLH) with
    error' cost error <= level stays ``margin_m`` from every face, at every angle of the body; that of the end is one.
    """

    code: Literal["proved", "not_proved"]
    point_m: list[float] | None
    gain: list[list[float]] | None = Field(description="2 x 4, 1/s^2 and 1/s.")
    cost: list[list[float]] | None = Field(description="4 x 4, symmetric.")
    level: float | None
    margin_m: float | None


class GoNoGoOutputs(WireModel):
    """Arrays over the states, in their order; margins per face in metres."""

    method: MethodName
    question: QuestionKind
    rest: Rest
    r_sync_m: float | None = Field(
        description="The paper's synchronization range limit, m; null when there is none."
    )
    r_sync_reason: str | None = Field(None, description="Why r_sync_m is null.")
    faces: list[str] = Field(description="Names of the corridor's faces, in the order of face_margins_m.")
    verdict: list[Literal["GO", "NO_GO", "UNDECIDED"]]
    decided_by: list[str | None] = Field(description=DECIDED_BY)
    margin_m: list[float | None] = Field(
        description="certified, exact, atlas: proved bound on the margin (distance to every face; limits in metres, "
        "see docs), from below for GO, from above for NO_GO, null when UNDECIDED. paper: smallest margin of each "
        "state, m; its GO needs it positive."
    )
    face_margins_m: list[list[float]] = Field(
        description="The paper's conditions (not sound): margin after erosion per state and face, m."
    )
    range_margin_m: list[float | None] = Field(
        description="The paper's conditions: r_sync minus range, m; null without a limit."
    )
    binding: list[str] = Field(
        description="The paper's conditions: what gives the smallest margin, a face or 'range'."
    )
    violated_faces: list[list[str]] = Field(
        description="Faces of the corridor that the start itself is outside of."
    )
    reason: list[str] = Field(description="The verdict in a sentence.")
    end_s: list[float | None] | None = Field(
        None,
        description="When the flight of a GO is at rest in the hold ball (synchronize), s; null for the others.",
    )
    examples: list[list[Member]] | None = Field(
        None,
        description="With half-widths: for each UNDECIDED state the members looked at, one GO and one NO_GO where the "
        "verdict depends on which member is true.",
    )
    tracking: list[TrackingAnswer] | None = Field(
        None, description="Method tracking: the controller's flight from each start, beside the exact answer."
    )
    proof: list[dict[str, Any] | None] | None = Field(
        None, description="Proof documents for `safestart verify`, when asked for; null for UNDECIDED."
    )
    # Untyped, so that results that do not have it have no table of it; GoNoGoAnswer types it.
    hold_after: list[dict[str, Any] | None] | None = Field(
        None, description=f"{HOLD_AFTER} Each is a HoldAfter, as in the answer on one start."
    )


SPEC = ProcessSpec(
    id="go-no-go",
    title="Go/no-go for starts at rest",
    description=(
        "May a chaser at rest start its approach? No GO without a proof: by default a certificate in closed form "
        "answers at once where it says GO, for ever, and the exact answer or an atlas decides the others. The paper's "
        "conditions (method paper) are not sound: their GO may be impossible to fly."
    ),
    inputs=GoNoGoInputs,
    outputs=GoNoGoOutputs,
    kernels=("exact answers",),
    run="safestart.processes.go_no_go.run:run",
    light=True,
    at_once="safestart.processes.go_no_go.run:output_at_once",
    parts="safestart.processes.go_no_go.run:parts",
    cost=lambda inputs: cost(inputs, len(inputs.states)),
    states="states",
    tables=(
        Table(
            "states",
            (
                *(
                    "verdict",
                    "decided_by",
                    "margin_m",
                    "face_margins_m",
                    "range_margin_m",
                    "binding",
                    "violated_faces",
                ),
                *("reason", "end_s", "tracking"),
            ),
        ),
    ),
    views=(
        Findings(
            "Verdicts",
            "states",
            word="verdict",
            columns=(
                Column("decided by", "decided_by"),
                Column("margin [m]", "margin_m"),
                Column("why", "reason"),
                Column("binding in the paper's conditions", "binding"),
                Column("faces violated at the start", "violated_faces"),
                Column("at rest after [s]", "end_s"),
            ),
            basis="method",
            unproved=UNPROVED,
        ),
        Facts(
            (
                Column("Method", "method"),
                Column("Question", "question"),
                Column("At rest in", "rest"),
                Column("Synchronization radius of the paper [m]", "r_sync_m"),
                Column("Why there is none", "r_sync_reason"),
                Column("Faces", "faces"),
            )
        ),
        Picture(
            "Starts",
            "x [m], target's body frame",
            "y [m], target's body frame",
            (
                Layer(
                    "start", "points", "states", "states.x_m", "states.y_m", value="verdict", beside="states"
                ),
            ),
            equal=True,
        ),
    ),
    keywords=("certificate", "go/no-go"),
    example={"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "states": [{"x_m": 5, "y_m": 40}]},
)
