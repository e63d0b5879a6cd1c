"""sweep-in-space: which starts around one really fly, and what the exact certificate says of them."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from safestart.papers.envisat import TUMBLING
from safestart.processes.base import ProcessSpec, Table, WireModel
from safestart.processes.costs import FIRST_S, program_s
from safestart.processes.start_in_space.parts import SpaceStart
from safestart.processes.start_in_space.space_scenario import SpaceScenario
from safestart.processes.sweep.controllers import CONTROLLERS
from safestart.processes.sweep.outputs import SweepConfusion
from safestart.processes.views import Column, Facts, Matrices, Rows
from safestart.processes.wire import DISTINCT, Horizon, Seed, Triple

MOST_CASES = 5000
WHY_NOT = {
    "filter": "its prediction and its corridor are those of the orbit plane",
    "filter_fine": "its prediction and its corridor are those of the orbit plane",
}
"""Controllers of the planar sweep that fly nothing in space, with the reason."""

_Half = Annotated[float, Field(ge=0, le=1000)]


def _middle() -> SpaceStart:
    return SpaceStart(position_m=[0.0, 30.0, 0.0], frame="body")


class _Centre(WireModel):
    """Stands last among the bases, so that the starts are the first fields."""

    centre: SpaceStart = Field(default_factory=_middle, description="Middle of the starts.")
    position_half_width_m: Annotated[list[_Half], Field(min_length=3, max_length=3)] = Field(
        [20.0, 20.0, 20.0], description="Starts are drawn evenly within these of the middle, its axes, m."
    )
    velocity_half_width_m_s: Annotated[list[_Half], Field(min_length=3, max_length=3)] = Field(
        [0.0, 0.0, 0.0], description="The same for the velocity, m/s."
    )
    cases: int = Field(200, ge=1, le=MOST_CASES, description="Starts.")
    seed: Seed = 0


class SweepInSpaceInputs(SpaceScenario, _Centre):
    """One scenario, the starts, the controllers and their navigation."""

    controllers: Annotated[list[str], DISTINCT] = Field(
        ["sequence"],
        min_length=1,
        max_length=len(CONTROLLERS),
        description="sequence: MPC over the whole thrust sequence. The others of the planar sweep are refused with the "
        "reason.",
    )
    horizon_s: Horizon = Field(60.0, description="Flight time, s; a multiple of 2 s.")
    position_sigma_m: float = Field(0.0, ge=0, le=100, description="White noise of navigation, m.")
    velocity_sigma_m_s: float = Field(0.0, ge=0, le=10, description="White noise of navigation, m/s.")

    @model_validator(mode="after")
    def _flown_here(self) -> SweepInSpaceInputs:
        for name in self.controllers:
            if name not in CONTROLLERS:
                raise ValueError(f"controllers: required some of {', '.join(CONTROLLERS)}, received {name}")
            if name in WHY_NOT:
                raise ValueError(f"controllers: {name} flies nothing in space: {WHY_NOT[name]}")
        return self


class FlownCase(WireModel):
    """One start and its flight."""

    case: int
    position_m: Triple = Field(description="LVLH, m.")
    velocity_m_s: Triple = Field(description="LVLH, m/s.")
    exact: str = Field(description="Verdict of the exact question stay.")
    exact_margin_m: float | None = Field(description="Its proved bound, m.")
    flown_margin_m: float = Field(description="Least distance to a face until the flight left it, m.")
    violated_at_s: float | None
    delta_v_m_s: float


class SweepInSpaceOutputs(WireModel):
    """Shares of the starts inside the faces at t = 0; the others are counted only."""

    cases: int
    outside: int = Field(description="Starts outside the faces at t = 0: neither asked nor flown.")
    undecided: int = Field(description="Of the flown starts, those that the exact question leaves undecided.")
    confusion: dict[str, dict[str, SweepConfusion]] = Field(
        description="exact (GO) against a controller (flown without violation), over the decided starts."
    )
    flown_cases: list[int] = Field(description="Numbers of the flown starts.")
    exact_go: list[bool]
    stayed: list[bool]
    flown_margin_m: list[float]
    delta_v_m_s: list[float]
    worst: list[FlownCase] = Field(
        description="Flights that left the faces from a start with a proof, then the narrowest ones; at most 10."
    )


def _cost(inputs: SweepInSpaceInputs) -> float:
    noisy = inputs.position_sigma_m > 0.0 or inputs.velocity_sigma_m_s > 0.0
    flight = program_s(inputs.horizon_s) * (6.0 if noisy else 1.0) + 0.02 * inputs.horizon_s / 60.0
    return FIRST_S + inputs.cases * (program_s(inputs.horizon_s) + flight)


SPEC = ProcessSpec(
    id="sweep-in-space",
    title="Closed-loop sweep in space",
    description=(
        "Draws starts around a state, asks the exact question of each and flies it by the sequence controller with "
        "navigation noise, for any attitude, orbit, faces and thrusts; violations are looked for at all times. "
        "Confusion matrix with intervals, impulse, worst cases."
    ),
    inputs=SweepInSpaceInputs,
    outputs=SweepInSpaceOutputs,
    possible="safestart.processes.start_in_space.question:require_stay",
    run="safestart.processes.sweep_in_space.run:run",
    cost=_cost,
    keywords=("closed loop", "Monte Carlo", "MPC", "torque-free"),
    tables=(Table("flights", ("flown_cases", "exact_go", "stayed", "flown_margin_m", "delta_v_m_s")),),
    views=(
        Matrices(
            "The exact certificate against the controller",
            "Rows: the exact word on the start. Columns: whether the flight stayed inside the faces. A flight that is "
            "lost from a start with a proof is the controller's or the noise's, not a false proof. Intervals: Wilson, "
            "95 %.",
            path="confusion.*.*",
            names=("", ""),
            heading="{0}, flown by {1}",
            claims=("GO", "NO GO"),
            facts=("stayed", "left"),
            cells=("GO, stayed", "GO, lost in flight", "stayed, no GO", "NO GO, left"),
        ),
        Facts(
            (
                Column("Starts", "cases"),
                Column("outside the faces", "outside"),
                Column("which exact leaves undecided", "undecided"),
            )
        ),
        Rows(
            "Worst flights",
            "worst",
            (
                Column("case", "case"),
                Column("position [m]", "position_m"),
                Column("velocity [m/s]", "velocity_m_s"),
                Column("exact", "exact"),
                Column("its margin [m]", "exact_margin_m"),
                Column("flown [m]", "flown_margin_m"),
                Column("left after [s]", "violated_at_s"),
            ),
        ),
    ),
    example={
        "attitude": TUMBLING,
        "a_max_m_s2": 0.02,
        "cases": 20,
    },
)
