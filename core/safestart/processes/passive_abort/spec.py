"""passive-abort: whatever happens to one burn of a plan, does the chaser stay away from the target?"""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

from pydantic import Field, model_validator

from safestart.model.orbit import EARTH_RADIUS
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.passive_abort.wire import (
    AbortStartInput,
    BurnInput,
    ErrorsInput,
    FailuresInput,
    KeepOut,
    Orbits,
    SemiMajorAxis,
    ZoneInput,
)
from safestart.processes.views import Column, Facts, Findings, Rows

VerdictName = Literal["PROVED", "VIOLATED", "UNKNOWN"]
ModelName = Literal["linear", "nonlinear", "earth"]
MOST_TEXT = 6_000_000


class PassiveAbortInputs(WireModel):
    """A plan, its errors, the failures, the keep-out sphere and the horizon."""

    semi_major_axis_m: SemiMajorAxis = 8.1e6
    eccentricity: float = Field(
        0.0, ge=0, le=0.8, description="Of the target's orbit at the first burn (model earth)."
    )
    inclination_deg: float = Field(0.0, ge=0, le=180, description="Its inclination, deg (model earth).")
    argument_of_perigee_deg: float = Field(
        0.0, ge=-360, le=360, description="Its perigee, deg (model earth)."
    )
    true_anomaly_deg: float = Field(
        0.0,
        ge=-360,
        le=360,
        description="Where the target is at the first burn, from perigee, deg (model earth).",
    )
    start: AbortStartInput | None = Field(
        None, description="State right before the first burn, LVLH; a plan from a message brings it along."
    )
    burns: list[BurnInput] | None = Field(
        None, min_length=1, max_length=200, description="The plan, in order; or give plan."
    )
    plan: str | None = Field(
        None,
        max_length=MOST_TEXT,
        description="Instead of burns: CSV with time_s, dv_x_m_s, dv_y_m_s, dv_z_m_s (LVLH) and, if burns last, "
        "duration_s, as text; or the chaser's OPM or OCM with its manoeuvres, KVN or XML, as text.",
    )
    target: str | None = Field(
        None,
        max_length=MOST_TEXT,
        description="With a plan from a message: the target's OEM, OPM or OCM, as text. Its osculating orbit at the "
        "first burn is the orbit asked about.",
    )
    keep_out_m: KeepOut = Field(
        50.0, gt=0, le=1e5, description="Distance to keep from the target, or from each of the zones, m."
    )
    zones: list[ZoneInput] | None = Field(
        None,
        min_length=1,
        max_length=8,
        description="Bodies to keep keep_out_m away from, instead of the target's centre.",
    )
    abort_orbits: Orbits = 2.0
    errors: ErrorsInput = Field(default_factory=lambda: ErrorsInput.model_validate({}))
    failures: FailuresInput = Field(default_factory=lambda: FailuresInput.model_validate({}))
    model: ModelName = Field(
        "linear",
        description="Motion that the proof speaks about: linear (CWH); nonlinear (two point masses, circular orbit): "
        "what CWH leaves out is bounded by Lagrange's remainder, drifts of many kilometres are out of its reach; "
        "earth: both bodies about the Earth with J2, any eccentricity, near the plan as it is flown there.",
    )
    states: list[AbortStartInput] | None = Field(
        None,
        max_length=200,
        description="Model earth: states before each burn, around which the box of errors lies, as burns are planned "
        "anew; absent: the plan flown about the Earth without errors.",
    )
    error_level: bool = Field(
        True, description="Also find the greatest multiple of the errors that is proved."
    )

    @model_validator(mode="after")
    def _ordered(self) -> PassiveAbortInputs:
        self._one_plan()
        for before, after in pairwise(self.burns or []):
            if not before.time_s < after.time_s:
                raise ValueError("burns: in the order of their times, no two at once")
        if any(not any(burn.impulse_m_s) for burn in self.burns or []):
            raise ValueError("burns: impulses that are not zero")
        if self.model != "linear" and not self.errors.at_each_burn:
            raise ValueError(f"errors.at_each_burn: true where model is {self.model}")
        self._orbit()
        self._lasting()
        return self

    def _one_plan(self) -> None:
        if (self.burns is None) == (self.plan is None):
            raise ValueError("burns: the burns, or a file of them in plan, not both")
        if self.target is None:
            if self.start is None:
                raise ValueError("start: a state, but for a plan from a message, which comes with target")
            return
        if self.plan is None or self.start is not None:
            raise ValueError("target: the target's course beside a plan from a message, without start")
        ours = {"semi_major_axis_m", "eccentricity", "inclination_deg", "argument_of_perigee_deg"}
        given = sorted(self.model_fields_set & (ours | {"true_anomaly_deg"}))
        if given:
            raise ValueError(f"{given[0]}: not beside target, whose file says it")

    def _lasting(self) -> None:
        impulses = any(burn.duration_s == 0.0 for burn in self.burns or [])
        if impulses and self.failures.stuck_s > 0.0 and self.failures.acceleration_m_s2 == 0.0:
            raise ValueError("failures.acceleration_m_s2: more than 0 where an impulse may be stuck on")
        for before, after in pairwise(self.burns or []):
            if before.time_s + before.duration_s > after.time_s:
                raise ValueError(f"burns: each ends before the next, the one at {before.time_s:g} s does not")

    def _orbit(self) -> None:
        angles = self.inclination_deg, self.argument_of_perigee_deg, self.true_anomaly_deg
        if self.model != "earth":
            if self.eccentricity or any(angles) or self.states is not None:
                raise ValueError("model: earth, where eccentricity, angles of the orbit or states are given")
            return
        if self.semi_major_axis_m * (1.0 - self.eccentricity) <= EARTH_RADIUS:
            raise ValueError(f"eccentricity: a perigee above the Earth's surface, {EARTH_RADIUS:g} m")
        if self.states is not None and self.burns is not None and len(self.states) != len(self.burns):
            raise ValueError(f"states: one before each of the {len(self.burns)} burns")


class CaseOutput(WireModel):
    """One burn with one failure, over all its pieces of time."""

    burn: int = Field(description="Number of the burn, from 0; -1: none is made.")
    failure: Literal["missed", "cut short", "partial", "misdirected", "late", "stuck"]
    least_distance_m: float = Field(description="Proved: at no time nearer than this; 0: nothing is proved.")
    nearest_m: float | None = Field(description="A state within the errors comes this near; null: no search.")
    when_s: float | None = Field(description="When it does, s after the burn.")


class FlownAbortOutput(WireModel):
    """A flight to replay: from the state at ``begin_s`` the burns as they come, a push, then drift to ``look_s``."""

    burn: int
    failure: str
    begin_s: float
    position_m: list[float]
    velocity_m_s: list[float]
    burns: list[BurnInput]
    push_m_s2: list[float]
    push_s: float
    look_s: float
    distance_m: float


class ReadOutput(WireModel):
    """A plan as it was read from a file: the same fields as inputs ask the same question."""

    start: AbortStartInput
    burns: list[BurnInput]
    semi_major_axis_m: float
    eccentricity: float | None = Field(description="Of the target's osculating orbit; null: not from a file.")
    inclination_deg: float | None
    argument_of_perigee_deg: float | None
    true_anomaly_deg: float | None


class PassiveAbortOutputs(WireModel):
    """The verdict on the plan, what every case keeps, and the evidence."""

    verdict: VerdictName
    checked: bool | None = Field(
        description="true: the independent checker has looked at the proof and accepts it (or refuses it: then the "
        "verdict is UNKNOWN, and notes say why); false: it was not asked, as it would take long; null: no proof."
    )
    model: ModelName
    least_distance_m: float = Field(description="Proved over all cases and all times, m.")
    gap_m: float = Field(description="The part of keep_out_m that is not proved, m.")
    error_level: float | None = Field(
        description="lambda: the greatest multiple of all errors for which every case is proved; null: not asked for."
    )
    read: ReadOutput | None = Field(description="What plan and target say; null where burns are given.")
    cases: list[CaseOutput]
    counter_example: FlownAbortOutput | None
    notes: list[str]


SPEC = ProcessSpec(
    id="passive-abort",
    title="Missed burns: does a plan stay away from the target, proved",
    description=(
        "Any plan of impulses or burns near a target, on a circular orbit or about the Earth with J2 and any "
        "eccentricity: any one burn missed, cut short, late, partial, stuck on or misdirected, with errors of "
        "navigation and thrust. The least distance to the target, or to spheres, ellipsoids and boxes, is proved at "
        "all times of the drift that follows, in the linear (CWH), the nonlinear or the true motion, with a document "
        "that safestart verify checks; or a flight to replay that comes too near; or UNKNOWN with the gap."
    ),
    inputs=PassiveAbortInputs,
    outputs=PassiveAbortOutputs,
    run="safestart.processes.passive_abort.run:run",
    possible="safestart.processes.passive_abort.question:require_possible",
    views=(
        Findings(
            "Verdict",
            "",
            word="verdict",
            columns=(
                Column("proved distance [m]", "least_distance_m"),
                Column("gap [m]", "gap_m"),
                Column("error level", "error_level"),
                Column("proof checked", "checked"),
                Column("model", "model"),
            ),
            good=("PROVED",),
            bad=("VIOLATED",),
        ),
        Rows(
            "Cases",
            "cases",
            (
                Column("burn", "burn"),
                Column("failure", "failure"),
                Column("proved distance [m]", "least_distance_m"),
                Column("nearest state found [m]", "nearest_m"),
                Column("after [s]", "when_s"),
            ),
        ),
        Facts(
            (
                Column("Counter-example: burn", "counter_example.burn"),
                Column("failure", "counter_example.failure"),
                Column("comes to [m]", "counter_example.distance_m"),
                Column("at [s]", "counter_example.look_s"),
            )
        ),
    ),
    keywords=("verification", "passive safety", "abort", "hopping"),
    example={
        "start": {"position_m": [0, 182.06, 0], "velocity_m_s": [0, 0, 0]},
        "burns": [
            {"time_s": 0, "impulse_m_s": [0.0178, 0, 0]},
            {"time_s": 3627.5, "impulse_m_s": [0.0178, 0, 0]},
        ],
        "keep_out_m": 40,
        "abort_orbits": 1,
    },
)
