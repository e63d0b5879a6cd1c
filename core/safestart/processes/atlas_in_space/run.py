"""Run atlas-in-space: survey every plane, draw them, write the proofs."""

from __future__ import annotations

from typing import Any

import numpy as np
import orjson

from safestart.atlas.plane_atlas import PlaneAtlas
from safestart.exact.space.prove import proof_in_space
from safestart.processes.atlas_in_space.plots import polygons
from safestart.processes.atlas_in_space.spec import AtlasInSpaceInputs
from safestart.processes.atlas_in_space.survey import rows, survey
from safestart.processes.base import Artifact, ProcessOutput
from safestart.runtime.progress import Context


def run(inputs: AtlasInSpaceInputs, context: Context) -> ProcessOutput:
    """Build an atlas of every plane."""
    asked, found = survey(inputs, context)
    artifacts: list[Any] = [polygons(asked, found)]
    if inputs.proofs:
        documents = {said.name: _proofs(atlas) for said, atlas in zip(asked, found, strict=True)}
        artifacts.append(Artifact("proofs.json", "application/json", orjson.dumps(documents)))
    return ProcessOutput({"planes": rows(asked, found)}, tuple(artifacts))


def _proofs(atlas: PlaneAtlas) -> dict[str, list[dict[str, Any]]]:
    """A document for every corner, and for a start just beyond every edge of the outer polygon that a bound cuts."""
    go = [proof_in_space(atlas.question, *atlas.answer_at(corner)) for corner in atlas.corners]
    no_go = []
    for a, b in zip(atlas.outer, np.roll(atlas.outer, -1, axis=0), strict=True):
        middle = 0.5 * (a + b)
        for bound in atlas.bounds:
            scale = float(np.abs(bound.slope) @ (atlas.plane.high - atlas.plane.low))
            if scale > 0.0 and abs(bound.level + float(bound.slope @ middle)) < 1e-9 * (
                scale + abs(bound.level)
            ):
                no_go.append(proof_in_space(atlas.question, *atlas.answer_beyond(bound, middle)))
                break
    return {"go": go, "no_go": no_go}
