"""Run region-in-space: survey every plane."""

from __future__ import annotations

from safestart.processes.atlas_in_space.survey import rows, survey
from safestart.processes.base import ProcessOutput
from safestart.processes.region_in_space.spec import RegionInSpaceInputs
from safestart.runtime.progress import Context


def run(inputs: RegionInSpaceInputs, context: Context) -> ProcessOutput:
    """The polygons of every plane."""
    planes = rows(*survey(inputs, context))
    first = planes[0]
    return ProcessOutput(
        {
            "planes": planes,
            "first_inner_polygon": first["inner_polygon"],
            "first_outer_polygon": first["outer_polygon"],
        }
    )
