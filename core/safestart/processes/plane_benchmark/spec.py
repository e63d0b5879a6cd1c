"""plane-benchmark: the engines that apply in space, on any plane of starts."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from safestart.engines.registry import ENGINES, engine_spec, why_not_in_space
from safestart.papers.envisat import TUMBLING
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.start_in_space.plane_input import PlaneAxis, PlaneInput
from safestart.processes.start_in_space.space_scenario import SpaceScenario
from safestart.processes.views import Column, Facts, Overlay, Rows
from safestart.processes.wire import DISTINCT, Horizon, Seed

MOST_POINTS = 2601
IN_SPACE = tuple(spec for spec in ENGINES.values() if spec.in_space)


def _plane() -> PlaneInput:
    return PlaneInput(
        name="xy",
        first=PlaneAxis(direction=[1.0, 0.0, 0.0], low=-60.0, high=60.0),
        second=PlaneAxis(direction=[0.0, 1.0, 0.0], low=0.0, high=120.0),
    )


class PlaneBenchmarkInputs(SpaceScenario):
    """One scenario, a plane of starts, and what to compare on it."""

    plane: PlaneInput = Field(
        default_factory=_plane, description="The starts; absent: x and y of the body frame, at rest in LVLH."
    )
    across: int = Field(21, ge=2, le=201, description="Points along the first coordinate.")
    along: int = Field(21, ge=2, le=201, description="Points along the second coordinate.")
    engines: Annotated[list[str], DISTINCT] = Field(
        [spec.name for spec in IN_SPACE],
        min_length=1,
        max_length=len(ENGINES),
        description=f"Engines to run: {', '.join(spec.name for spec in IN_SPACE)}. Others are refused with the reason.",
    )
    horizon_s: Horizon = Field(
        40.0, description="Inside all faces at this time, s; Monte Carlo: at all times up to it."
    )
    position_sigma_m: float = Field(
        0.0, ge=0, le=100, description="Monte Carlo: white noise of navigation, m."
    )
    velocity_sigma_m_s: float = Field(
        0.0, ge=0, le=10, description="Monte Carlo: white noise of navigation, m/s."
    )
    seed: Seed = 0

    @model_validator(mode="after")
    def _answered(self) -> PlaneBenchmarkInputs:
        if self.across * self.along > MOST_POINTS:
            raise ValueError(f"across: across * along at most {MOST_POINTS}")
        kind = self.thrust.kind if self.thrust else "ball"
        for name in self.engines:
            why = why_not_in_space(name, kind) if name in ENGINES else f"one of {', '.join(ENGINES)}"
            if why:
                raise ValueError(f"engines: {name} does not answer here: {why}")
        return self


class PlaneRow(WireModel):
    """What one engine found on the plane; measures without a mask or a reference are null."""

    engine: str
    code: str
    message: str
    cells: int | None = Field(description="Points of the plane in the engine's set.")
    area: float | None = Field(description="In the units of the two coordinates.")
    area_ratio_vs_exact: float | None
    iou_vs_exact: float | None
    violation_vs_exact: float | None = Field(description="|A minus exact| / |A|.")
    run_s: float
    detail: dict[str, Any]


class PlaneBenchmarkOutputs(WireModel):
    """Rows in the order of the engines asked for; masks and margins are in the NPZ artifact."""

    inside_cells: int = Field(
        description="Points inside all faces at t = 0, to which every set is restricted."
    )
    cell_area: float
    axes: list[str] = Field(description="The two coordinates, with their units.")
    rows: list[PlaneRow]


SPEC = ProcessSpec(
    id="plane-benchmark",
    title="The reachability engines on a plane of starts in space",
    description=(
        "Runs exact, backward, forward and Monte Carlo (sequence controller) on any plane of starts, of positions or "
        "of a position and a velocity, for any attitude, orbit, faces and thrusts, and compares their sets. An engine "
        "that cannot answer is refused with the reason."
    ),
    inputs=PlaneBenchmarkInputs,
    outputs=PlaneBenchmarkOutputs,
    possible="safestart.processes.start_in_space.question:require_stay",
    kernels=("exact answers",),
    run="safestart.processes.plane_benchmark.run:run",
    keywords=("reachability", "torque-free", "Monte Carlo", "IoU"),
    views=(
        Facts(
            (
                Column("Points inside all faces", "inside_cells"),
                Column("Area of a point", "cell_area"),
                Column("Coordinates", "axes"),
            )
        ),
        Rows(
            "Engines",
            "rows",
            (
                Column("engine", "engine"),
                Column("code", "code"),
                Column("points", "cells"),
                Column("area", "area"),
                Column("IoU with exact", "iou_vs_exact"),
                Column("area / exact", "area_ratio_vs_exact"),
                Column("outside exact", "violation_vs_exact"),
                Column("run [s]", "run_s"),
            ),
        ),
        Overlay("Agreement on the plane", "maps.npz", table="rows", by="engine", certain="exact"),
    ),
    extensions={"safestart:engines": [engine_spec(spec.name).document() for spec in IN_SPACE]},
    example={
        "attitude": TUMBLING,
        "a_max_m_s2": 0.1,
        "across": 11,
        "along": 11,
    },
)
