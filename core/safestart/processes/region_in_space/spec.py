"""region-in-space: slices of the starts that can stay, at once; atlas-in-space has the picture and the proofs."""

from __future__ import annotations

import math

from pydantic import Field

from safestart.processes.atlas_in_space.spec import EXAMPLE, PLANE_VIEWS, AtlasInSpaceOutputs, PlanesAsked
from safestart.processes.base import ProcessSpec
from safestart.processes.costs import FIRST_S, program_s

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


SPEC = ProcessSpec(
    id="region-in-space",
    title="Slices of the exact safe-start region in space",
    description=(
        "The starts of some planes that can stay, for any attitude, orbit, faces and thrusts: inside the inner polygon "
        "proved GO, outside the outer one proved NO_GO. Process atlas-in-space gives the proofs."
    ),
    inputs=RegionInSpaceInputs,
    outputs=AtlasInSpaceOutputs,
    run="safestart.processes.region_in_space.run:run",
    light=True,
    cost=_cost,
    keywords=("exact", "safe-start region", "torque-free"),
    views=PLANE_VIEWS,
    example=EXAMPLE,
)
