"""atlas-in-space: the starts that can stay, between proved polygons, in any planes of starts."""

from __future__ import annotations

from typing import Any, Self

from pydantic import Field, model_validator

from safestart.model.scenario import Rest
from safestart.papers.envisat import TUMBLING
from safestart.processes.base import ProcessSpec, WireModel
from safestart.processes.start_in_space.parts import Position
from safestart.processes.start_in_space.plane_input import PlaneInput, coordinate_planes
from safestart.processes.start_in_space.space_scenario import SpaceScenario
from safestart.processes.views import Column, Rows
from safestart.processes.wire import Horizon, Pair, Triple

MOST_PLANES = 6


class PlanesAsked(SpaceScenario):
    """One scenario, the planes, and how narrow the strips between the polygons must be."""

    planes: list[PlaneInput] = Field(
        default_factory=list,
        max_length=MOST_PLANES,
        description="Planes of starts; none: the three coordinate planes of the body frame through centre_m.",
    )
    centre_m: Position = Field(
        default_factory=lambda: [0.0, 30.0, 0.0],
        description="Of the coordinate planes, body frame, m; only without planes.",
    )
    size_m: float = Field(
        150.0, ge=0.1, le=10_000, description="Their extent to every side, m; only without planes."
    )
    rest: Rest = Field(Rest.LVLH, description="What their starts are at rest in; only without planes.")
    horizon_s: Horizon = Field(60.0, description="How long to stay, s.")
    gap: float = Field(
        0.01, ge=1e-4, le=1, description="Largest share of an outer polygon's area that stays undecided."
    )
    most_questions: int = Field(400, ge=10, le=5000, description="Exact questions that a plane may take.")

    @model_validator(mode="after")
    def _planes_apart(self) -> Self:
        names = [plane.name for plane in self.planes]
        if len(set(names)) != len(names):
            raise ValueError("planes: each name once")
        given = {"centre_m", "size_m", "rest"} & self.model_fields_set
        if self.planes and given:
            raise ValueError(f"{sorted(given)[0]}: only where no planes are given")
        return self

    def asked(self) -> list[PlaneInput]:
        """The planes given, or the three coordinate planes."""
        return self.planes or coordinate_planes(self.centre_m, self.size_m, self.rest)


class AtlasInSpaceInputs(PlanesAsked):
    """What the atlas is of, and whether its proofs are wanted."""

    proofs: bool = Field(
        False,
        description="Artifact proofs.json: proof documents of every corner (GO) and of a start beyond every edge of "
        "the outer polygon (NO_GO), by plane.",
    )


class PlanePolygons(WireModel):
    """One plane; points are values of its two coordinates."""

    name: str
    axes: list[str] = Field(description="The two coordinates, with their units.")
    inner_area: float = Field(description="Of the proved GO, in the units of the coordinates.")
    outer_area: float = Field(description="Outside of which NO_GO is proved.")
    relative_gap: float = Field(description="(outer - inner) / outer area.")
    deepest_start: list[float] | None = Field(description="The start with the largest margin found.")
    deepest_margin_m: float | None
    inner_polygon: list[Pair] = Field(description="Corners of the proved GO, counter-clockwise.")
    outer_polygon: list[Pair] = Field(
        description="Corners of the outer polygon; empty: every start is NO_GO."
    )
    half_planes: list[Triple] = Field(
        description="Rows (a, b, c): a x first + b x second + c bounds the margin of every start, m; negative proves "
        "NO_GO."
    )
    questions: int = Field(description="Exact questions that it took.")
    message: str


class AtlasInSpaceOutputs(WireModel):
    """The planes in the order asked for."""

    planes: list[PlanePolygons]


EXAMPLE: dict[str, Any] = {
    "attitude": TUMBLING,
    "a_max_m_s2": 0.1,
    "size_m": 200,
    "gap": 0.05,
}
PLANE_VIEWS = (
    Rows(
        "Planes",
        "planes",
        (
            Column("plane", "name"),
            Column("coordinates", "axes"),
            Column("proved GO", "inner_area"),
            Column("outside NO_GO", "outer_area"),
            Column("share undecided", "relative_gap"),
            Column("deepest start", "deepest_start"),
            Column("its margin [m]", "deepest_margin_m"),
            Column("questions", "questions"),
            Column("", "message"),
        ),
    ),
)

SPEC = ProcessSpec(
    id="atlas-in-space",
    title="Proof atlas of the starts that can stay, in planes in space",
    description=(
        "Exact answer for all starts of planes of positions, or of a position and a velocity, for any attitude, orbit, "
        "faces and thrusts: an inner polygon of proved GO (the margin is concave: starts between starts that stay do "
        "stay), half-planes of proved NO_GO around it, and a thin strip undecided."
    ),
    inputs=AtlasInSpaceInputs,
    outputs=AtlasInSpaceOutputs,
    possible="safestart.processes.start_in_space.question:require_stay",
    kernels=("exact answers",),
    run="safestart.processes.atlas_in_space.run:run",
    keywords=("exact", "proof", "safe-start region", "torque-free"),
    views=PLANE_VIEWS,
    example=EXAMPLE,
)
