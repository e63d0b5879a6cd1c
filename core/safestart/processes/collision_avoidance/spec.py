"""collision-avoidance: unsafe set, capture set, escape modes and closed-loop encounters of paper 001."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from safestart.model.scenario import MAX_ACCELERATION, MAX_MEAN_MOTION
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.views import Column, Facts, Findings, Rows
from safestart.processes.wire import DISTINCT, Seed, Thrust

PilotName = Literal["certified", "hj", "supervisor", "mode1", "mode2", "mode3", "mode4", "pd", "coast"]
AdversaryName = Literal["worst", "mirror", "pursuit", "random", "none"]
Speed = Annotated[float, Field(ge=-100, le=100)]
Velocity = Annotated[list[Speed], Field(min_length=2, max_length=2)]
Number = Annotated[float, Field(ge=-1e6, le=1e6)]
State = Annotated[list[Number], Field(min_length=4, max_length=6)]

MAX_STATES = 1000
MAX_FLIGHTS = 1_000_000
MAX_NODES = 3_000_000


class BoxInput(WireModel):
    """Half-widths of the box of states that the grid covers; missing ones follow from the problem."""

    position_m: float = Field(450.0, gt=0, le=100_000, description="Half-width of x and y, m.")
    speed_m_s: float = Field(6.0, gt=0, le=100, description="Half-width of the speeds, m/s.")


class GameGridInput(WireModel):
    """The grid of the level set."""

    nodes_position: int = Field(31, ge=7, le=101, description="Nodes along x and along y.")
    nodes_speed: int = Field(15, ge=5, le=61, description="Nodes along each speed.")
    accuracy: Literal["low", "medium", "high", "very_high"] = Field(
        "very_high", description="First order, ENO2, WENO3 or WENO5."
    )
    kept: int = Field(7, ge=2, le=31, description="Times to go at which the value is kept.")
    box: BoxInput | None = Field(
        default_factory=lambda: BoxInput.model_validate({}),
        description="Half-widths; null: sized so that no motion leaves it, which makes a coarse grid.",
    )


class SlotInput(WireModel):
    """The recovery box, eq. (19): where the chaser keeps station."""

    x_m: float = Field(1000.0, ge=-100_000, le=100_000, description="Tangential stand-off, m.")
    y_m: float = Field(0.0, ge=-100_000, le=100_000, description="Radial offset, m.")
    half_x_m: float = Field(50.0, gt=0, le=10_000)
    half_y_m: float = Field(25.0, gt=0, le=10_000)
    half_speed_m_s: float = Field(0.01, gt=0, le=10, description="Half-width of both speeds, m/s.")


class ConjunctionInput(WireModel):
    """An encounter from a Conjunction Data Message; its state is asked about after those of ``states``."""

    cdm: str = Field(min_length=1, max_length=1_000_000, description="CDM, KVN or XML, as text.")
    chaser: Literal["OBJECT1", "OBJECT2"] = Field(
        "OBJECT1", description="Which object is Player 1; the states are in the LVLH of the other one."
    )
    before_s: float = Field(
        60.0,
        ge=0,
        le=600,
        description="How long before the closest approach the game begins, s; both coast until then.",
    )


class CollisionAvoidanceInputs(WireModel):
    """Game, grid, recovery, and the encounters to fly; the defaults are the paper's if it gives any."""

    mean_motion_rad_s: float = Field(1.1e-3, ge=0, le=MAX_MEAN_MOTION, description="Mean motion, rad/s.")
    keep_out_m: float = Field(100.0, gt=0, le=10_000, description="Separation to be kept (d_FCC), m.")
    horizon_s: float = Field(60.0, ge=1, le=600, description="Horizon of the game, s.")
    thrust_m_s2: Thrust = 0.1
    disturbance_m_s2: float = Field(
        0.05, ge=0, le=MAX_ACCELERATION, description="Largest acceleration of Player 2, m/s^2."
    )
    shape: Literal["box", "disk"] = Field(
        "box", description="Both players' sets: bounds by axis (the paper), or on the size."
    )
    players: Literal["avoid", "paper"] = Field(
        "avoid",
        description="avoid: Player 1 evades. paper: eq. (12) as printed, where it seeks the disk; no encounters.",
    )
    fuel_price_s: float = Field(
        0.0,
        ge=0,
        le=1000,
        description="Running cost, metres of separation that 1 m/s of fuel is worth; hj coasts where thrust pays less.",
    )
    grid: GameGridInput = Field(default_factory=lambda: GameGridInput.model_validate({}))
    states: Annotated[list[State], Field(max_length=MAX_STATES)] = Field(
        [],
        description="States to be judged: (x, y, vx, vy), or in space (x, y, z, vx, vy, vz), m and m/s; x tangential.",
    )
    conjunction: ConjunctionInput | None = Field(
        None, description="An encounter from a CDM; its orbit takes the place of mean_motion_rad_s."
    )
    slices_m_s: Annotated[list[Velocity], Field(min_length=1, max_length=6)] = Field(
        [[0.0, 0.0], [-4.0, 0.0], [-3.0, -3.0]],
        description="Relative velocities (tangential, radial) at which the unsafe set is drawn, m/s.",
    )
    slot: SlotInput = Field(default_factory=lambda: SlotInput.model_validate({}))
    capture_horizon_s: float = Field(1100.0, ge=10, le=5000, description="Horizon of the capture set, s.")
    capture_radial_m_s: Annotated[list[Speed], Field(min_length=1, max_length=4)] = Field(
        [-4.0, 0.0, 4.0], description="Radial speeds at which the capture set is drawn, m/s."
    )
    burn_s: float = Field(60.0, gt=0, le=3600, description="Burn of the escape modes in their picture, s.")
    encounters: int = Field(300, ge=10, le=20_000, description="Starts per set: outside and inside.")
    supervised: int = Field(60, ge=0, le=2000, description="Supervised flights, with recovery; 0: none.")
    threat_s: float = Field(300.0, ge=0, le=3600, description="How long Player 2 acts in those, s.")
    supervised_s: float = Field(1800.0, ge=60, le=7200, description="How long those last, s.")
    band_m: float = Field(20.0, gt=0, le=1000, description="Values up to which a start counts as near, m.")
    period_s: float = Field(1.0, ge=0.1, le=10, description="Control period, s.")
    pilots: Annotated[list[PilotName], Field(min_length=1), DISTINCT] = Field(
        ["certified", "hj", "supervisor", "mode1", "mode2", "mode3", "mode4", "pd", "coast"]
    )
    adversaries: Annotated[list[AdversaryName], Field(min_length=1), DISTINCT] = Field(
        ["worst", "mirror", "pursuit", "random", "none"]
    )
    seed: Seed = 0

    @model_validator(mode="after")
    def _sizes(self) -> CollisionAvoidanceInputs:
        if self.grid.nodes_position**2 * self.grid.nodes_speed**2 > MAX_NODES:
            raise ValueError(f"grid: at most {MAX_NODES} nodes in all")
        if any(len(state) == 5 for state in self.states):
            raise ValueError("states: each of 4 numbers, or of 6 in space")
        if self.period_s > self.horizon_s:
            raise ValueError("period_s: at most horizon_s")
        flights = 2 * self.encounters * len(self.pilots) * len(self.adversaries)
        if flights > MAX_FLIGHTS:
            raise ValueError(f"encounters: at most {MAX_FLIGHTS} flights in all, received {flights}")
        if self.disturbance_m_s2 > self.thrust_m_s2:
            raise ValueError("disturbance_m_s2: at most thrust_m_s2, or Player 1 can promise nothing")
        return self


class JudgedRow(WireModel):
    """The verdict on one of the requested states."""

    state: list[float]
    answer: Literal["PROVED_UNSAFE", "UNSAFE", "UNDECIDED", "SAFE", "PROVED_SAFE"] = Field(
        description="Proved for the linear model, or judged by the grid beyond its measured error."
    )
    least_m: float | None = Field(description="Lower bound on the separation above the keep-out distance.")
    most_m: float = Field(description="Upper bound on it.")


class ConjunctionRow(WireModel):
    """What the CDM says, and the state that was asked about."""

    chaser: str
    other: str
    closest_approach: str = Field(description="UTC.")
    miss_distance_m: float
    sigma_m: list[float] = Field(
        description="Standard deviations of the relative position there: tangential, radial, normal, m."
    )
    mean_motion_rad_s: float = Field(description="Of the other object's orbit, rad/s.")
    state: list[float] = Field(description="before_s ahead: (x, y, z, vx, vy, vz), x tangential, m and m/s.")


class EncounterRow(WireModel):
    """One pilot against one adversary from one set of starts."""

    starts: Literal["outside", "inside", "approaching"]
    pilot: PilotName
    adversary: AdversaryName
    encounters: int
    lost: int = Field(description="Came within the keep-out distance.")
    lost_beyond_error: int = Field(description="Came within it by more than the grid error.")
    breach_probability: float
    breach_low: float = Field(description="Wilson interval, 95 %.")
    breach_high: float
    least_separation_m: float = Field(description="At all times, between control periods too.")
    mean_delta_v_m_s: float


class RequirementRow(WireModel):
    """One statement about the encounters; HELD, BROKEN, or UNDECIDED without flights."""

    requirement: str
    verdict: Literal["HELD", "BROKEN", "UNDECIDED"]
    encounters: int
    broken: int
    probability: float | None
    low: float | None = Field(description="Wilson interval, 95 %.")
    high: float | None


class EscapeRow(WireModel):
    """The outcome of one escape mode: one burn, then free motion."""

    mode: str
    paper_says: str
    drift_m_s: float = Field(description="Mean tangential speed after the burn.")
    altitude_m: float = Field(description="Mean radial position after the burn.")
    overtakes_s: float | None = Field(
        description="Time at which it passes its start again; null: not in an orbit."
    )


class CaptureRow(WireModel):
    """One slice of the capture set."""

    radial_m_s: float
    captured_percent: float = Field(description="Of the drawn positions, by flight.")
    median_s: float | None = Field(description="Median time of those that arrive.")


class CollisionAvoidanceOutputs(WireModel):
    """Verdicts, encounters, and results on the sets."""

    failure: str = Field(
        description="Why the value cannot be trusted; empty otherwise. Then nothing is called safe."
    )
    requirements: list[RequirementRow]
    states: list[JudgedRow]
    conjunction: ConjunctionRow | None = Field(
        None, description="The encounter of the CDM, where one was given."
    )
    encounters: list[EncounterRow]
    grid_error_m: float | None = Field(description="Largest error of the grid near the boundary.")
    nodes: dict[str, int] = Field(description="Numbers of nodes by proof and by the grid's verdict.")
    unsafe_percent: float | None = Field(description="Unsafe share of the grid's box.")
    supervisor: dict[str, int] = Field(description="Transitions and recoveries of the supervised flights.")
    escape: list[EscapeRow]
    capture: list[CaptureRow]
    capture_level_set: dict[str, int | str] = Field(
        description="Numbers of nodes by flight and by level set; the flight is the truth."
    )
    notes: list[str]


SPEC = ProcessSpec(
    id="collision-avoidance",
    title="Collision avoidance between two satellites",
    description=(
        "The game of Hui et al.: the states from which separation cannot be kept (proved, and by a level set whose "
        "error is measured), the capture set of the recovery slot, the escape modes, and closed-loop encounters "
        "with breach probabilities for every pilot and adversary."
    ),
    inputs=CollisionAvoidanceInputs,
    outputs=CollisionAvoidanceOutputs,
    kernels=("level sets in double precision", "collision avoidance"),
    run="safestart.processes.collision_avoidance.run:run",
    possible="safestart.processes.collision_avoidance.conjunction:require_possible",
    views=(
        Findings(
            "Findings",
            "requirements",
            word="verdict",
            columns=(
                Column("requirement", "requirement"),
                Column("encounters", "encounters"),
                Column("broken in", "broken"),
                Column("probability", "probability"),
                Column("from", "low"),
                Column("to (95 %)", "high"),
            ),
        ),
        Facts(
            (
                Column("Why the value cannot be trusted", "failure"),
                Column("Largest grid error near the boundary [m]", "grid_error_m"),
                Column("Unsafe share of the grid's box [%]", "unsafe_percent"),
            )
        ),
        Rows(
            "States asked about",
            "states",
            (
                Column("answer", "answer"),
                Column("separation above keep-out, at least [m]", "least_m"),
                Column("at most [m]", "most_m"),
                *(Column(f"state {k + 1}", f"state.{k}") for k in range(6)),
            ),
        ),
        Rows(
            "Encounters",
            "encounters",
            (
                Column("starts", "starts"),
                Column("pilot", "pilot"),
                Column("adversary", "adversary"),
                Column("encounters", "encounters"),
                Column("lost", "lost"),
                Column("lost beyond the grid's error", "lost_beyond_error"),
                Column("breach probability", "breach_probability"),
                Column("from", "breach_low"),
                Column("to (95 %)", "breach_high"),
                Column("least separation [m]", "least_separation_m"),
                Column("mean delta-v [m/s]", "mean_delta_v_m_s"),
            ),
        ),
    ),
    keywords=("collision avoidance", "Hamilton-Jacobi", "game", "closed loop"),
    example={"encounters": 100, "supervised": 20, "grid": {"nodes_position": 21, "nodes_speed": 11}},
)
