"""tracking-mpc: one flight, its certificate, the region it can start from, and a Monte Carlo study (paper 002)."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from safestart.model.orbit import EARTH_RADIUS, MU
from safestart.papers.envisat import INERTIA_KG_M2
from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.sharding import Sharding
from safestart.processes.tracking_mpc.outputs import TrackingMpcOutputs
from safestart.processes.tracking_mpc.targets import presets
from safestart.processes.views import Column, Facts, Findings, Matrices, Overlay, Rows, Scene
from safestart.processes.wire import Seed

MAX_RUNS = 100_000
MAX_PERIOD_S = 60.0
MAX_RATE_DEG_S = 60.0
Triple = list[float]


class DockingCorridorInput(WireModel):
    """Prism of Rebollo et al., eq. (4), fixed in the body: y >= 0, |x| <= x0 + y / c_x, |z| <= z0 + y / c_z."""

    c_x: float = Field(1.0, gt=0, le=1000, description="Slope of the +-x sides.")
    c_z: float = Field(1.0, gt=0, le=1000, description="Slope of the +-z sides.")
    x0_m: float = Field(0.1, ge=0, le=1000, description="Half-width of the port in x, m.")
    z0_m: float = Field(0.1, ge=0, le=1000, description="Half-width of the port in z, m.")


class TrackingStartInput(WireModel):
    """Where the chaser starts."""

    position_m: Triple = Field([1.5, 2.5, 1.5], min_length=3, max_length=3, description="Body frame, m.")
    velocity_m_s: Triple = Field([0.0, 0.0, 0.0], min_length=3, max_length=3, description="LVLH, m/s.")

    @model_validator(mode="after")
    def _near(self) -> TrackingStartInput:
        if max(map(abs, self.position_m)) > 1000 or max(map(abs, self.velocity_m_s)) > 10:
            raise ValueError("start: within 1000 m and 10 m/s")
        return self


class RegionInput(WireModel):
    """Starts y = 0.25 + 0.5 i, x = +-(0.25 + 0.5 j) inside the corridor, in layers of z (body), at rest in LVLH."""

    rows: int = Field(30, ge=1, le=100, description="Rows i; 30 rows of the paper's corridor are 930 starts.")
    z_m: list[Annotated[float, Field(ge=-1000, le=1000)]] = Field(
        [0.0], min_length=1, max_length=20, description="Layers, body z, m."
    )


class StudyInput(WireModel):
    """Flights with errors: a part of each is drawn anew in every step, a part once per run."""

    runs: int = Field(1000, ge=1, le=MAX_RUNS, description="Flights.")
    variant: Literal["hard", "soft", "tube"] = Field(
        "tube",
        description=(
            "hard: without a plan the last one is followed; soft: least violation, then cost; tube: Kalman filter, "
            "tightened rows, and soft where these have no plan."
        ),
    )
    tube: Literal["three_sigma", "bounded"] = Field(
        "bounded",
        description="Tightening by the sum of 3 sigma of all steps (bounded errors), or by the root of squares.",
    )
    position_sigma_m: float = Field(0.01, ge=0, le=10, description="Navigation, per axis and step, m.")
    velocity_sigma_m_s: float = Field(0.001, ge=0, le=1, description="Navigation, per axis and step, m/s.")
    input_sigma: float = Field(0.01, ge=0, le=1, description="Size of each impulse, share, per step.")
    spin_sigma: float = Field(
        0.01, ge=0, le=0.5, description="Rate that the controller believes, share, per run."
    )
    inertia_sigma: float = Field(
        0.02, ge=0, le=0.2, description="True principal moments, share of each, per run."
    )
    per_shard: int = Field(250, ge=1, le=10_000, description="Runs per shard.")


class TrackingMpcInputs(WireModel):
    """Target, orbit, controller and start; the defaults are the paper's Table I with the recommended weights."""

    inertia_kg_m2: list[Triple] = Field(
        default_factory=lambda: [list(row) for row in INERTIA_KG_M2],
        min_length=3,
        max_length=3,
        description="Inertia of the target, body axes, kg m^2; Envisat.",
    )
    attitude_wxyz: list[float] = Field(
        [1.0, 0.0, 0.0, 0.0],
        min_length=4,
        max_length=4,
        description="LVLH to body at t = 0, scalar first: r_B = C r_L, C = (s^2 - v.v) I + 2 v v^T - 2 s [v]x. "
        "Scaled to length 1.",
    )
    body_rate_deg_s: Triple = Field(
        [0.0, 3.53, 3.53], min_length=3, max_length=3, description="Angular velocity, body axes, deg/s."
    )
    attitude_reference: Literal["inertial", "lvlh"] = Field(
        "inertial",
        description="inertial: the rate is inertial and LVLH turns; lvlh: the paper's (2)-(3), LVLH taken as inertial, "
        "with which the paper's figures hold. Not go-no-go's lvlh, a rate relative to the turning LVLH.",
    )
    orbit_radius_m: float = Field(7_144_800.0, ge=EARTH_RADIUS, le=1e9, description="Circular orbit, m.")
    period_s: float = Field(
        1.0, gt=0, le=MAX_PERIOD_S, description="Length T of a step, s; an impulse ends it."
    )
    u_max_m_s: float = Field(0.075, ge=1e-9, le=100, description="Largest input per step, m/s.")
    input_limit: Literal["box", "ball"] = Field(
        "box",
        description="box: u_max_m_s per body axis. ball: in length; plans use a polyhedron of 62 faces inside it.",
    )
    thrust: Literal["impulse", "held"] = Field(
        "impulse",
        description="impulse: at the end of each step. held: an acceleration over the step, u_max_m_s / period_s at "
        "most, in LVLH; the input is acceleration x period_s.",
    )
    corridor: DockingCorridorInput = Field(
        default_factory=lambda: DockingCorridorInput.model_validate({}), description="Corridor in the body."
    )
    n_c: int = Field(3, ge=1, le=60, description="Free inputs of a plan.")
    n_lqr: int = Field(
        30, ge=1, le=200, description="Steps of the regulator after them, then two of dead-beat."
    )
    rho: float = Field(100.0, gt=0, le=1e6, description="Weight of |u - u_e|^2.")
    tau: float = Field(100.0, ge=0, le=1e6, description="Weight of |theta|^2.")
    theta_limit: Literal["printed", "ball", "corners", "polytope", "zero"] = Field(
        "polytope",
        description=(
            "Limit on the artificial reference: (42) as printed (not safe for every spin), the rigorous ball, the "
            "largest cut whose corners can be held, the inputs' own rows, or the target alone."
        ),
    )
    start: TrackingStartInput = Field(
        default_factory=lambda: TrackingStartInput.model_validate({}), description="Start."
    )
    steps: int = Field(60, ge=3, le=600, description="Steps of the flight, and of any impulse history.")
    truth: Literal["hcw", "two_body_j2"] = Field("hcw", description="Motion that is flown.")
    inertia_error: float = Field(
        0.02, ge=0, le=0.2, description="Error that the certificate looks at, share."
    )
    spin_error: float = Field(0.01, ge=0, le=0.2, description="Error that the certificate looks at, share.")
    region: RegionInput | None = Field(None, description="Ask which starts the controller can take, too.")
    study: StudyInput | None = Field(None, description="Fly with errors, too.")
    seed: Seed = 0

    @field_validator("inertia_kg_m2")
    @classmethod
    def _square(cls, value: list[Triple]) -> list[Triple]:
        if any(len(row) != 3 for row in value):
            raise ValueError("three rows of three numbers")
        return value

    @field_validator("body_rate_deg_s")
    @classmethod
    def _slow(cls, value: Triple) -> Triple:
        if math.hypot(*value) > MAX_RATE_DEG_S:
            raise ValueError(f"three numbers, together at most {MAX_RATE_DEG_S:g} deg/s")
        return value

    @model_validator(mode="after")
    def _horizons(self) -> TrackingMpcInputs:
        if self.n_c > self.n_lqr:
            raise ValueError(f"n_c: at most n_lqr, {self.n_lqr}")
        return self

    @property
    def mean_motion(self) -> float:
        """rad/s."""
        return math.sqrt(MU / self.orbit_radius_m**3)


_SETS = (
    (
        "tracking_mpc",
        "the tracking MPC has a plan",
        "#009E73",
        "starts from which the first program has a plan",
    ),
    ("arrives", "its flight arrives", "#0072B2", "of these, starts whose flight keeps every row and arrives"),
    ("any_history", "some impulse history", "#E69F00", "starts from which some history keeps every row"),
)

SPEC = ProcessSpec(
    id="tracking-mpc",
    title="MPC for tracking a tumbling target",
    description=(
        "Rebollo et al., corrected: a chaser docks with a target that tumbles freely about three axes. One flight with "
        "its certificate, the starts that the controller can take beside those that any impulse history can, and a "
        "Monte Carlo study over navigation, input, spin and inertia errors. Pictures; the study in parts."
    ),
    inputs=TrackingMpcInputs,
    outputs=TrackingMpcOutputs,
    possible="safestart.processes.tracking_mpc.possible:require_possible",
    kernels=("tracking",),
    sharding=Sharding.of("safestart.processes.tracking_mpc"),
    tables=(Table("flight", ("time_s", "range_m", "cost_to_go", "slack_m")),),
    views=(
        Findings(
            "Certificate",
            "statements",
            word="verdict",
            columns=(Column("statement", "statement"), Column("figure", "figure")),
        ),
        Facts(
            (
                Column("Under 5 cm after [s]", "time_to_5cm_s"),
                Column("Under 1 cm after [s]", "time_to_1cm_s"),
                Column("Impulse [m/s]", "impulse_m_s"),
                Column("Cost", "cost"),
            )
        ),
        Scene("The flight about the tumbling target", "scene.npz"),
        Overlay("Which starts", "region.npz", table="region.sets", by="set", certain="tracking_mpc"),
        Matrices(
            "The controller against any impulse history",
            "Rows: the controller's program has a plan (tracking_mpc), its flight arrives (arrives). Columns: some "
            "history keeps the corridor or none does. Intervals: Wilson, 95 %.",
            path="region.matrices.*",
            names=("claim",),
            heading="{0}",
            claims=("taken", "not taken"),
            facts=("some history", "none"),
            cells=("taken, possible", "taken, impossible", "possible, not taken", "neither"),
        ),
        Rows(
            "Flight",
            "flight",
            (
                Column("t [s]", "time_s"),
                Column("range [m]", "range_m"),
                Column("cost", "cost_to_go"),
                Column("distance to the corridor's faces [m]", "slack_m"),
            ),
        ),
    ),
    extensions={
        "safestart:engines": [
            dict(zip(("name", "title", "colour", "summary"), one, strict=True)) for one in _SETS
        ],
        "safestart:examples": presets({"n_c": 3, "theta_limit": "polytope", "region": {"rows": 10}}),
    },
    keywords=("MPC", "tracking", "tumbling", "docking", "guidance"),
    example={"n_c": 3, "theta_limit": "polytope", "region": {"rows": 10}},
)
