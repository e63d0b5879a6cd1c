"""region-in-space: slices of the starts that can stay, at once; atlas-in-space has all pictures and the proofs."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field

from safestart.processes.atlas_in_space.spec import EXAMPLE, PLANE_VIEWS, AtlasInSpaceOutputs, PlanesAsked
from safestart.processes.base import ProcessSpec, Table
from safestart.processes.costs import FIRST_S, program_s
from safestart.processes.views import Layer, Picture
from safestart.processes.wire import Pair

_QUESTIONS = 25.0
"""What a plane takes at a gap of 0.05; it grows with the inverse of the gap's root."""


class RegionInSpaceInputs(PlanesAsked):
    """As for atlas-in-space, with wider strips unless asked otherwise."""

    gap: float = Field(
        0.05, ge=1e-3, le=1, description="Largest share of an outer polygon's area that stays undecided."
    )


def _cost(inputs: RegionInSpaceInputs) -> float:
    questions = min(float(inputs.most_questions), _QUESTIONS * math.sqrt(0.05 / inputs.gap))
    return FIRST_S + program_s(inputs.horizon_s) * questions * len(inputs.asked())


class RegionInSpaceOutputs(AtlasInSpaceOutputs):
    """The planes in the order asked for; the polygons of the first one once more, as tables for its picture."""

    first_inner_polygon: list[Pair] = Field(description="inner_polygon of the first plane.")
    first_outer_polygon: list[Pair] = Field(description="outer_polygon of the first plane.")


def _layer(title: str, table: str, colour: Literal["exact", "lost"]) -> Layer:
    return Layer(title, "area", table, f"{table}.0", f"{table}.1", colour=colour)


SPEC = ProcessSpec(
    id="region-in-space",
    title="Slices of the exact safe-start region in space",
    description=(
        "The starts of some planes that can stay, for any attitude, orbit, faces and thrusts: inside the inner polygon "
        "proved GO, outside the outer one proved NO_GO. Process atlas-in-space gives the proofs."
    ),
    inputs=RegionInSpaceInputs,
    outputs=RegionInSpaceOutputs,
    run="safestart.processes.region_in_space.run:run",
    light=True,
    cost=_cost,
    keywords=("exact", "safe-start region", "torque-free"),
    tables=(
        Table("first_inner_polygon", ("first_inner_polygon",)),
        Table("first_outer_polygon", ("first_outer_polygon",)),
    ),
    views=(
        *PLANE_VIEWS,
        Picture(
            "Starts that can stay, in the first plane",
            "{planes.0.axes.0}",
            "{planes.0.axes.1}",
            (
                _layer("proved GO", "first_inner_polygon", "exact"),
                _layer("outside: proved NO_GO", "first_outer_polygon", "lost"),
            ),
        ),
    ),
    example=EXAMPLE,
)
