"""commit-timeline: intervals of GO, NO_GO and UNDECIDED from the files of chaser and target."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.commit_timeline.example import EXAMPLE
from safestart.processes.sharding import Sharding
from safestart.processes.views import Column, Facts, Findings, Rows
from safestart.processes.wire import CorridorInput, Horizon, Thrust

MOST_STEPS = 100_000
MOST_TEXT = 6_000_000
_EPOCH = r"^\d{4}-(\d{2}-\d{2}|\d{3})T\d{2}:\d{2}:\d{2}(\.\d{1,9})?Z?$"
Vector = list[float]


class SpinInput(WireModel):
    """A steady spin against LVLH, where no attitude file is given."""

    rate_deg_s: float = Field(ge=-60, le=60, description="Rate about the axis, deg/s.")
    axis: Vector = Field(
        default_factory=lambda: [0.0, 0.0, 1.0], min_length=3, max_length=3, description="Axis, LVLH."
    )
    phase_deg: float = Field(
        0.0,
        ge=-360,
        le=360,
        description="By how much the body is ahead of LVLH at the start of the span, deg.",
    )


class NamedCorridor(CorridorInput):
    """One corridor, fixed in the body, along an axis."""

    name: str = Field("corridor", min_length=1, max_length=40, description="Name in the answer.")
    axis: Vector = Field(
        default_factory=lambda: [0.0, 1.0, 0.0],
        min_length=3,
        max_length=3,
        description="Direction along which it opens, body frame.",
    )


class CommitTimelineInputs(WireModel):
    """Two courses, an attitude, a chaser and one corridor or several."""

    chaser: str = Field(max_length=MOST_TEXT, description="OEM or OCM of the chaser, KVN or XML, as text.")
    target: str = Field(max_length=MOST_TEXT, description="OEM or OCM of the target, KVN or XML, as text.")
    attitude: str | None = Field(
        None, max_length=MOST_TEXT, description="AEM of the target, KVN or XML, as text; else give spin."
    )
    spin: SpinInput | None = Field(None, description="Steady spin against LVLH; else give attitude.")
    a_max_m_s2: Thrust
    corridors: list[NamedCorridor] = Field(
        default_factory=lambda: [NamedCorridor()],
        min_length=1,
        max_length=8,
        description="Each has its own timeline.",
    )
    start: str | None = Field(
        None,
        pattern=_EPOCH,
        max_length=40,
        description="Begin of the span, UTC; absent: where both courses begin.",
    )
    stop: str | None = Field(
        None, pattern=_EPOCH, max_length=40, description="End of the span, UTC; absent: where a course ends."
    )
    step_s: float = Field(10.0, ge=0.1, le=600, description="Distance of the instants that are asked, s.")
    bracket_s: float = Field(
        0.1,
        ge=0.001,
        le=600,
        description="A change of verdict between two instants is closed in on to this, s.",
    )
    horizon_s: Horizon = Field(
        60.0, description="How long the approach must be able to stay in the corridor, s."
    )
    sense: Literal["rotating", "inertial"] | None = Field(
        None, description="How covariances in RTN or RSW are meant, where the file does not say it."
    )
    confidence: float | None = Field(
        None,
        ge=0.5,
        le=1.0 - 1e-9,
        description="Ask for every start in the box around the chaser's state that holds it with at least this "
        "probability, by the files' covariances; absent: the states are taken as known.",
    )
    proofs: bool = Field(True, description="Make the proofs of both ends of every interval.")


class Interval(WireModel):
    """A run of instants with one verdict: proved at each of them, not between them."""

    corridor: str
    verdict: Literal["GO", "NO_GO", "UNDECIDED"]
    begin: str = Field(description="First instant, UTC.")
    end: str = Field(description="Last instant, UTC.")
    begin_s: float = Field(description="Seconds since the span's start.")
    end_s: float
    instants: int = Field(description="Instants that were asked in the interval.")
    margin_m: float | None = Field(
        description="The proved bound nearest to 0 in the interval, m: GO from below, NO_GO from above; null: none."
    )
    model_error_m: float = Field(
        description="About how far a flight of the linear model may be from the true one, m; the largest of the "
        "interval. The reason says where it exceeds a margin."
    )
    reason: str
    begin_proof: str | None = Field(description="SHA-256 of the proof at the first instant, in proofs.json.")
    end_proof: str | None = Field(description="The same at the last instant.")


class CommitTimelineOutputs(WireModel):
    """Intervals by corridor, in time."""

    start: str = Field(description="Begin of the span, UTC.")
    stop: str = Field(description="End of the span, UTC.")
    steps: int = Field(description="Instants step_s apart; more were asked where the verdict changes.")
    chaser: str
    target: str
    go_s: float = Field(description="Seconds of GO, of all corridors together.")
    first_go: str | None = Field(description="First instant of GO, UTC.")
    largest_eccentricity: float | None = Field(description="Of the target's osculating orbit over the span.")
    largest_half_width_m: float | None = Field(
        description="Of the boxes of starts over the span, m; None where the states are taken as known."
    )
    intervals: list[Interval]


SPEC = ProcessSpec(
    id="commit-timeline",
    title="Commit timeline",
    description=(
        "When may the chaser leave its course and start its approach? From the ephemerides of both craft and the "
        "attitude of the target (CCSDS OEM, OCM, AEM): intervals of GO, NO_GO and UNDECIDED with proofs at their ends. "
        "GO: from the state of that instant a thrust history stays in the corridor for horizon_s."
    ),
    inputs=CommitTimelineInputs,
    outputs=CommitTimelineOutputs,
    possible="safestart.processes.commit_timeline.courses:require_possible",
    kernels=("exact answers",),
    sharding=Sharding.of("safestart.processes.commit_timeline", light="split"),
    views=(
        Findings(
            "Intervals",
            "intervals",
            word="verdict",
            columns=(
                Column("corridor", "corridor"),
                Column("from", "begin"),
                Column("to", "end"),
                Column("margin [m]", "margin_m"),
                Column("why", "reason"),
            ),
        ),
        Facts(
            (
                Column("Chaser", "chaser"),
                Column("Target", "target"),
                Column("From", "start"),
                Column("To", "stop"),
                Column("Instants", "steps"),
                Column("GO [s]", "go_s"),
                Column("First GO", "first_go"),
                Column("Largest eccentricity", "largest_eccentricity"),
            )
        ),
        Rows(
            "All intervals",
            "intervals",
            (
                Column("corridor", "corridor"),
                Column("verdict", "verdict"),
                Column("from [s]", "begin_s"),
                Column("to [s]", "end_s"),
                Column("instants", "instants"),
                Column("error of the model [m]", "model_error_m"),
                Column("proof at the first", "begin_proof"),
                Column("at the last", "end_proof"),
            ),
        ),
    ),
    keywords=("exact", "CCSDS", "timeline"),
    example=EXAMPLE,
)
