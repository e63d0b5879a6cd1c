"""flight: fly the best thrust history from one start, and show how close it comes to every face."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from safestart.model.scenario import Rest
from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.costs import FIRST_S, program_s
from safestart.processes.go_no_go.question_fields import QuestionKind
from safestart.processes.go_no_go.spec import StateInput
from safestart.processes.views import Column, Findings, Layer, Picture
from safestart.processes.wire import Horizon, PlanarOrSolid, ScenarioInput

_IN_SPACE = {"starts", "position_m", "velocity_m_s", "attitude", "orbit", "thrust"}


class FlightInputs(ScenarioInput):
    """One operating point and one start at rest."""

    start: StateInput
    rest: Rest = Field(Rest.LVLH, description="Frame in which the start is at rest.")
    question: QuestionKind = Field(
        "stay",
        description="stay: in the corridor for horizon_s. synchronize: also at rest in the hold ball at the end, "
        "within within_s; where that is not GO, the best attempt to stay is flown.",
    )
    horizon_s: Horizon = Field(60.0, description="How long to stay in the corridor, s.")
    within_s: Horizon = Field(200.0, description="Latest end of synchronize, s.")

    @model_validator(mode="before")
    @classmethod
    def _in_the_plane_s_corridor(cls, values: Any) -> Any:
        """A question in space is named with the process that flies it."""
        if isinstance(values, dict):
            start = values.get("start")
            asked = sorted(_IN_SPACE & {*values, *(start if isinstance(start, dict) else ())})
            if asked:
                raise ValueError(
                    "start: required x_m and y_m, at rest beside a steady spin about the orbit's normal (process "
                    f"flight-in-space flies any other start, attitude, orbit and thrust), received {', '.join(asked)}"
                )
        return values


class FlightOutputs(WireModel):
    """Curves over ``time_s`` (K,), four per interval of 2 s; vectors as rows (x, y) or (x, y, z), m and m/s^2."""

    verdict: Literal["GO", "NO_GO", "UNDECIDED"] = Field(description="Of the exact question.")
    margin_m: float | None = Field(description="Proved bound: from below for GO, from above for NO_GO.")
    time_s: list[float]
    body_m: list[PlanarOrSolid] = Field(description="Position in the target's body frame.")
    lvlh_m: list[PlanarOrSolid] = Field(description="Position in LVLH.")
    lvlh_m_s: list[PlanarOrSolid] = Field(description="Velocity in LVLH, m/s.")
    thrust_m_s2: list[PlanarOrSolid] = Field(description="Acceleration in LVLH, held over each interval.")
    faces: list[str]
    distance_m: list[list[float]] = Field(description="Distance to each face over time; negative: outside.")
    closest_face: str
    closest_m: float = Field(description="Smallest distance along the curves.")
    closest_s: float = Field(description="When it is reached.")
    delta_v_m_s: float


def _cost(inputs: FlightInputs) -> float:
    """Two programs at most: where synchronize is not GO, the best attempt to stay is flown."""
    synchronize = program_s(inputs.within_s) if inputs.question == "synchronize" else 0.0
    return FIRST_S + synchronize + program_s(inputs.horizon_s)


SPEC = ProcessSpec(
    id="flight",
    title="Best flight from a start",
    description=(
        "Flies the thrust history of the largest margin from one start at rest: for a GO the witness of its proof, for "
        "a NO_GO the attempt that fails by least. Positions in both frames, thrust, distance to every face."
    ),
    inputs=FlightInputs,
    outputs=FlightOutputs,
    kernels=("exact answers",),
    run="safestart.processes.flight.run:run",
    courses="safestart.processes.flight.files:kept_courses",
    light=True,
    cost=_cost,
    tables=(Table("flight", ("time_s", "body_m", "lvlh_m", "lvlh_m_s", "thrust_m_s2", "distance_m")),),
    views=(
        Findings(
            "Verdict",
            "",
            word="verdict",
            columns=(
                Column("proved margin [m]", "margin_m"),
                Column("closest [m]", "closest_m"),
                Column("to face", "closest_face"),
                Column("after [s]", "closest_s"),
                Column("delta-v [m/s]", "delta_v_m_s"),
            ),
        ),
        Picture(
            "Flight",
            "x [m], target's body frame",
            "y [m], target's body frame",
            (Layer("flight", "line", "flight", "body_m.0", "body_m.1"),),
            equal=True,
        ),
        Picture(
            "Distance to each face",
            "time [s]",
            "distance [m]",
            tuple(Layer(f"{{faces.{k}}}", "line", "flight", "time_s", f"distance_m.{k}") for k in range(5)),
        ),
    ),
    keywords=("exact", "trajectory"),
    example={"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "start": {"x_m": 5, "y_m": 40}},
)
