"""hop-plan: the hops of an approach, its burns, and what is proved of every hop, at once."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.hopping.spec import PlanOutput, SigmaInput
from safestart.processes.hopping.wire import HopsInput, require_outside
from safestart.processes.passive_abort.wire import KeepOut, Orbits, SemiMajorAxis
from safestart.processes.views import Column, Facts, Findings, Layer, Picture, Rows
from safestart.processes.wire import Pair, Triple

Verdict = Literal["PROVED", "VIOLATED", "UNKNOWN"]


class HopPlanInputs(HopsInput):
    """The target's orbit, the line and its hops, the keep-out sphere, the errors; as in ``hopping``."""

    angle_deg: float = Field(
        0.0, ge=0, le=360, description="Line from the target: 0 V-bar ahead, 90 R-bar below, deg."
    )
    keep_out_m: KeepOut = 50.0
    semi_major_axis_m: SemiMajorAxis = 8.1e6
    sigma: SigmaInput = Field(default_factory=lambda: SigmaInput.model_validate({}))
    abort_orbits: Orbits = 2.0
    document: bool = Field(False, description="Give the proof document, which safestart verify checks.")

    @model_validator(mode="after")
    def _holds_outside(self) -> HopPlanInputs:
        require_outside(self.hold_m, self.keep_out_m)
        return self


class HopProofOutput(WireModel):
    """The drift after a hop's impulse, for all errors in a box of one standard deviation."""

    hop: int = Field(description="From 1.")
    verdict: Verdict = Field(
        description="PROVED: keeps out at all times; VIOLATED: a drift within the errors enters; else UNKNOWN."
    )
    least_distance_m: float = Field(description="Proved; 0: nothing is.")
    nearest_m: float = Field(description="A drift within the errors comes this near.")


class HopPlanBurnOutput(WireModel):
    """An impulse: one before each hop, and one that stops at the hold point. LVLH: radial, along-track, cross-track."""

    burn: int = Field(description="From 1.")
    time_s: float
    distance_m: float
    position_m: Triple
    impulse_m_s: Triple


class HopPlanDriftOutput(WireModel):
    """A free drift after a hop's impulse, sampled evenly over the abort."""

    hop: int
    member: Literal["planned", "within errors", "worst found"]
    verdict: Verdict = Field(description="Of its hop.")
    radial_m: list[float]
    along_track_m: list[float]


class HopPlanOutputs(WireModel):
    """Verdict and level, hops, burns, and paths to draw."""

    verdict: Verdict = Field(
        description="The worst of the hops; UNKNOWN where the drift from the start is not proved to keep out, too."
    )
    lambda_: float | None = Field(
        alias="lambda",
        description="Greatest multiple of the standard deviations, as a box, for which all hops are proved to keep "
        "out, to 0.5 % from below; null where all are 0.",
    )
    plan: PlanOutput
    proofs: list[HopProofOutput]
    burns: list[HopPlanBurnOutput]
    path: list[Pair] = Field(description="Of all hops, LVLH: radial and along-track, m.")
    drifts: list[HopPlanDriftOutput]
    document: dict[str, Any] | None = Field(
        description="Proof of the hops in CWH motion (safestart-abort-proof/1); null where it is not asked for or the "
        "verdict is not PROVED."
    )
    notes: list[str]


SPEC = ProcessSpec(
    id="hop-plan",
    title="A hopping approach, planned and proved",
    description=(
        "The hops of an approach along any line through the target, its burns, time and fuel, and for every hop the "
        "proof in continuous time that a chaser whose thrusters die keeps out, for all errors in a box (CWH motion). "
        "Drifts within the errors for a picture. hopping flies the same approach about the true Earth."
    ),
    inputs=HopPlanInputs,
    outputs=HopPlanOutputs,
    run="safestart.processes.hop_plan.run:run",
    light=True,
    cost=lambda inputs: 0.02 * inputs.hops * max(inputs.abort_orbits, 1.0),
    tables=(Table("path", ("path",)),),
    views=(
        Findings(
            "Proof of each hop",
            "proofs",
            word="verdict",
            columns=(
                Column("hop", "hop"),
                Column("proved distance [m]", "least_distance_m"),
                Column("nearest drift found [m]", "nearest_m"),
            ),
            good=("PROVED",),
            bad=("VIOLATED",),
        ),
        Facts(
            (
                Column("Error level lambda", "lambda"),
                Column("Length [orbits]", "plan.orbits"),
                Column("Fuel, 1-norm [m/s]", "plan.fuel_1norm_m_s"),
                Column("2-norm [m/s]", "plan.fuel_2norm_m_s"),
            )
        ),
        Picture(
            "Path of the hops, the target at 0",
            "along-track [m]",
            "radial [m]",
            (Layer("hops", "line", "path", "path.1", "path.0", colour="exact"),),
            equal=True,
        ),
        Rows(
            "Burns",
            "burns",
            (
                Column("burn", "burn"),
                Column("time [s]", "time_s"),
                Column("distance [m]", "distance_m"),
                Column("radial [m/s]", "impulse_m_s.0"),
                Column("along-track [m/s]", "impulse_m_s.1"),
            ),
        ),
    ),
    keywords=("hopping", "guidance", "abort", "verification"),
    example={"angle_deg": 130, "hops": 5, "hold_m": 100},
)
