"""hopping: an approach of paper 004 along any line, its proof, and how often an aborted one would enter a sphere."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from safestart.model.orbit import EARTH_RADIUS
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.hopping.wire import HopsInput, require_outside
from safestart.processes.passive_abort.wire import KeepOut, Orbits, SemiMajorAxis
from safestart.processes.sharding import Sharding
from safestart.processes.views import Column, Facts, Rows
from safestart.processes.wire import Seed

PER_SHARD = 100


class SigmaInput(WireModel):
    """Standard deviations of navigation, per axis, and of the thrust."""

    position_m: float = Field(0.5, ge=0, le=1e3, description="Navigation, position, m.")
    velocity_m_s: float = Field(1e-3, ge=0, le=10, description="Navigation, velocity, m/s.")
    thrust_share: float = Field(0.01, ge=0, le=0.3, description="Size of an impulse, relative.")
    thrust_deg: float = Field(0.5, ge=0, le=30, description="Direction of an impulse, deg.")


class HoppingInputs(HopsInput):
    """The target's orbit, the line and its hops, the keep-out sphere, the barrier, the noise, the runs."""

    semi_major_axis_m: SemiMajorAxis = 8.1e6
    inclination_deg: float = Field(0.0, ge=0, le=180, description="Inclination of the target's orbit, deg.")
    eccentricity: float = Field(
        0.0,
        ge=0,
        lt=1,
        description="Of the target's orbit, flown from its perigee; the plan is for a circle, and so is the proof "
        "unless proof_model is earth.",
    )
    angle_deg: float = Field(
        0.0, ge=0, le=360, description="Line from the target: 0 V-bar ahead, 90 R-bar below, deg."
    )
    keep_out_m: KeepOut = 50.0
    barrier: Literal["off", "nominal", "tightened"] = Field(
        "off",
        description="Keeps the drift after a failure out of the sphere: of the estimate, or with kappa sigma.",
    )
    kappa: float = Field(3.0, ge=0, le=10, description="Standard deviations of the drift that are kept free.")
    sigma: SigmaInput = Field(default_factory=lambda: SigmaInput.model_validate({}))
    drag_m_s2: float = Field(
        0.0,
        ge=-1e-3,
        le=1e-3,
        description="The chaser's deceleration by drag less the target's, in the flights only, m/s^2.",
    )
    proof_model: Literal["linear", "nonlinear", "earth"] = Field(
        "linear",
        description="Motion that the proof speaks about: linear (CWH); nonlinear (two point masses, circular orbit); "
        "earth: both bodies about the Earth with J2, on the given orbit from its perigee. As in passive-abort.",
    )
    runs: int = Field(200, ge=1, le=100_000, description="Approaches flown.")
    seed: Seed = 0
    abort_orbits: Orbits = 2.0

    @model_validator(mode="after")
    def _flies(self) -> HoppingInputs:
        require_outside(self.hold_m, self.keep_out_m)
        if self.semi_major_axis_m * (1.0 - self.eccentricity) <= EARTH_RADIUS:
            raise ValueError(f"eccentricity: a perigee above the Earth's surface, {EARTH_RADIUS:g} m")
        return self


class HopOutput(WireModel):
    """One hop; ``impulse_m_s`` is what begins it, LVLH."""

    start_m: float
    end_m: float
    rho: float
    orbits: float
    impulse_m_s: list[float]


class PlanOutput(WireModel):
    """The approach as planned, in CWH motion."""

    hops: list[HopOutput]
    stop_m_s: list[float] = Field(description="Impulse that stops at the hold point, LVLH, m/s.")
    orbits: float
    fuel_1norm_m_s: float
    fuel_2norm_m_s: float


class BreachOutput(WireModel):
    """How often the thrusters, dead after some hop's impulse, would let the chaser enter the sphere."""

    probability: float
    low: float = Field(description="Lower end of the Wilson interval of 95 %.")
    high: float = Field(description="Upper end.")
    count: int
    runs: int
    per_hop: list[float] = Field(description="The same after each hop's impulse alone.")


class StudyOutput(WireModel):
    """What the approaches flown cost, where they end, and their risk."""

    breach: BreachOutput
    stop_breach: BreachOutput = Field(
        description="The same after the stop at the hold point: drifting on from there; per_hop is empty."
    )
    fuel_1norm_m_s: float = Field(description="Mean.")
    fuel_2norm_m_s: float = Field(description="Mean.")
    hold_m: float = Field(description="Mean distance at the end.")
    hold_std_m: float
    barrier_failed: int = Field(description="Runs in which the barrier's true row did not hold at some hop.")


class ProofOutput(WireModel):
    """The missed-burn proof of the plan's hops, with a box of one standard deviation at each burn."""

    verdict: Literal["PROVED", "VIOLATED", "UNKNOWN"]
    checked: bool | None = Field(
        description="Whether the independent checker has looked at the proof, as in passive-abort."
    )
    model: Literal["linear", "nonlinear", "earth"] = Field(description="proof_model.")
    lambda_: float | None = Field(
        alias="lambda",
        description="Greatest multiple of the standard deviations, as a box, for which all hops are proved to keep "
        "out; null where all are 0.",
    )
    least_distance_m: list[float] = Field(
        description="Per hop: proved for every member of the box, at all times."
    )


class HoppingOutputs(WireModel):
    """Plan, study, proof."""

    plan: PlanOutput
    study: StudyOutput | None = Field(description="null before the first part is done.")
    proof: ProofOutput | None = Field(description="null in a partial result.")
    notes: list[str]


SPEC = ProcessSpec(
    id="hopping",
    title="Hopping approaches, their risk and their proof",
    description=(
        "V-bar, R-bar and any other line of Silva et al.: hops planned in closed form, flown by the MPC with a barrier "
        "about the true Earth (J2, noise, dispersed starts), with the probability and its interval that thrusters that "
        "die after some hop let the chaser enter the keep-out sphere, and the proof in continuous time of every hop. "
        "In parts."
    ),
    inputs=HoppingInputs,
    outputs=HoppingOutputs,
    sharding=Sharding.of("safestart.processes.hopping"),
    views=(
        Facts(
            (
                Column("Abort breach probability", "study.breach.probability"),
                Column("from (95 %)", "study.breach.low"),
                Column("to", "study.breach.high"),
                Column("Proof of the hops", "proof.verdict"),
                Column("proof checked", "proof.checked"),
                Column("Its motion", "proof.model"),
                Column("Error level lambda", "proof.lambda"),
                Column("Length [orbits]", "plan.orbits"),
                Column("Fuel planned, 1-norm [m/s]", "plan.fuel_1norm_m_s"),
                Column("2-norm [m/s]", "plan.fuel_2norm_m_s"),
                Column("Fuel flown, 1-norm [m/s]", "study.fuel_1norm_m_s"),
                Column("Distance at the end [m]", "study.hold_m"),
            )
        ),
        Rows(
            "Hops",
            "plan.hops",
            (
                Column("from [m]", "start_m"),
                Column("to [m]", "end_m"),
                Column("share left", "rho"),
                Column("length [orbits]", "orbits"),
                Column("radial [m/s]", "impulse_m_s.0"),
                Column("along-track [m/s]", "impulse_m_s.1"),
            ),
        ),
    ),
    keywords=("hopping", "MPC", "V-bar", "R-bar", "abort", "Monte Carlo"),
    example={"angle_deg": 0, "barrier": "tightened", "kappa": 3, "runs": 200},
)
