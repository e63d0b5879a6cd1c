"""passive-safety: proofs about the switched rendezvous of paper 003, with counter-examples where they fail."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.passive_safety.rendezvous import RendezvousInputs, TargetBox
from safestart.processes.views import Column, Facts, Findings
from safestart.processes.wire import Pair, Seed

Minutes = Annotated[float, Field(ge=0.0, le=600.0)]
Window = Annotated[list[Minutes], Field(min_length=2, max_length=2)]
VerdictName = Literal["SAFE", "UNSAFE", "UNKNOWN"]


class RendezvousStartInput(WireModel):
    """A start in Hill's frame of the target: x radial, y along-track."""

    x_m: float = Field(-900.0, ge=-2000, le=2000, description="Radial position, m.")
    y_m: float = Field(-400.0, ge=-2000, le=2000, description="Along-track position, m.")
    vx_m_s: float = Field(0.0, ge=-1, le=1, description="Radial velocity, m/s.")
    vy_m_s: float = Field(0.0, ge=-1, le=1, description="Along-track velocity, m/s.")


class SpreadInput(WireModel):
    """Half-widths of the box of starts around the centre."""

    x_m: float = Field(25.0, ge=0, le=500, description="Half-width in x, m.")
    y_m: float = Field(25.0, ge=0, le=500, description="Half-width in y, m.")
    vx_m_s: float = Field(0.0, ge=0, le=0.1, description="Half-width in vx, m/s.")
    vy_m_s: float = Field(0.0, ge=0, le=0.1, description="Half-width in vy, m/s.")


class PassiveSafetyInputs(RendezvousInputs):
    """Starts, horizon, abort windows, the target's box, and the rendezvous."""

    centre: RendezvousStartInput = Field(default_factory=lambda: RendezvousStartInput.model_validate({}))
    half_widths: SpreadInput = Field(default_factory=lambda: SpreadInput.model_validate({}))
    horizon_min: float = Field(
        300.0, gt=0, le=600, description="Horizon of powered flight and drift together, min."
    )
    abort_windows_min: list[Window] = Field(
        [[0.0, 240.0]],
        max_length=12,
        description="Windows [first, last] of the time of failure, min, each verified apart; empty: no failure.",
    )
    box_half_width_m: TargetBox = 0.1
    critical_abort: bool = Field(
        True, description="Also bracket the critical abort time, between 0 and the horizon."
    )
    critical_drift_min: float = Field(
        60.0,
        ge=0,
        le=120,
        description="How long a drift is followed after the last abort for the critical time, min.",
    )
    seed: Seed = 0

    @model_validator(mode="after")
    def _windows(self) -> PassiveSafetyInputs:
        for first, last in self.abort_windows_min:
            if not first <= last <= self.horizon_min:
                raise ValueError("abort_windows_min: first <= last <= horizon_min")
        return self


class RendezvousCounterExample(WireModel):
    """A flight to replay: fly from the start, cut the engines at ``abort_min``, look at ``time_min``."""

    x_m: float
    y_m: float
    vx_m_s: float
    vy_m_s: float
    abort_min: float | None = Field(description="When the engines fail, min; null: they work up to time_min.")
    time_min: float
    value: float = Field(description="The restricted quantity there, in the finding's unit.")


class FindingOutput(WireModel):
    """Answer for one requirement."""

    requirement: Literal["separation", "thrust", "los", "velocity", "velocity_disc"]
    verdict: VerdictName
    unit: str
    limit: float | None
    bound: float | None = Field(description="Proved extreme: least distance, else the greatest value.")
    margin: float | None = Field(description="Proved room to the limit.")
    reason: str
    counter_example: RendezvousCounterExample | None


class WindowOutput(WireModel):
    """Findings of one abort window."""

    abort_window_min: Pair | None
    findings: list[FindingOutput]
    run_s: float


class CriticalOutput(WireModel):
    """The critical abort time lies between its two sides."""

    proved_until_min: float | None = Field(
        description="Every abort from 0 to here is proved safe; null: none is."
    )
    counter_example: RendezvousCounterExample | None = Field(
        description="Collides after the earliest such abort found."
    )
    reason: str


class PassiveSafetyOutputs(WireModel):
    """Per window the findings; the crossing into mode 2; the critical abort time."""

    gains: dict[str, list[list[float]]] = Field(
        description="K (2 x 4) of mode1 and mode2: force = -K state, kg m/min^2 from m and m/min."
    )
    crossing_first_min: float | None
    crossing_last_min: float | None
    crossed_faces: list[str]
    windows: list[WindowOutput]
    critical: CriticalOutput | None
    notes: list[str]


SPEC = ProcessSpec(
    id="passive-safety",
    title="Passive safety of the switched rendezvous, proved",
    description=(
        "Reach tubes of the switched LQR rendezvous of Chan and Mitra (linear or nonlinear dynamics, published or own "
        "gains, octagon or circle as guard): thrust, line of sight, speed, and separation after an engine failure at "
        "any time of a window. SAFE is proved, UNSAFE comes with a flight to replay, UNKNOWN with a reason. Brackets "
        "the critical abort time."
    ),
    inputs=PassiveSafetyInputs,
    outputs=PassiveSafetyOutputs,
    kernels=("passive safety",),
    run="safestart.processes.passive_safety.run:run",
    views=(
        Findings(
            "Findings",
            "windows.findings",
            word="findings.verdict",
            columns=(
                Column("requirement", "findings.requirement"),
                Column("abort from [min]", "abort_window_min.0"),
                Column("to [min]", "abort_window_min.1"),
                Column("bound", "findings.bound"),
                Column("limit", "findings.limit"),
                Column("margin", "findings.margin"),
                Column("unit", "findings.unit"),
                Column("why", "findings.reason"),
                Column("counter-example: x [m]", "findings.counter_example.x_m"),
                Column("y [m]", "findings.counter_example.y_m"),
                Column("vx [m/s]", "findings.counter_example.vx_m_s"),
                Column("vy [m/s]", "findings.counter_example.vy_m_s"),
                Column("aborts at [min]", "findings.counter_example.abort_min"),
                Column("fails at [min]", "findings.counter_example.time_min"),
                Column("with", "findings.counter_example.value"),
            ),
        ),
        Facts(
            (
                Column("Every abort proved safe from 0 to [min]", "critical.proved_until_min"),
                Column("Earliest abort found that collides [min]", "critical.counter_example.abort_min"),
                Column("it collides at [min]", "critical.counter_example.time_min"),
                Column("from x [m]", "critical.counter_example.x_m"),
                Column("from y [m]", "critical.counter_example.y_m"),
                Column("What ended the proof", "critical.reason"),
                Column("Enters mode 2 from [min]", "crossing_first_min"),
                Column("to [min]", "crossing_last_min"),
                Column("through the faces", "crossed_faces"),
            )
        ),
    ),
    keywords=("verification", "passive safety", "hybrid system", "abort"),
    example={"abort_windows_min": [[120, 125], [0, 240]], "box_half_width_m": 0.1, "horizon_min": 300},
)
