"""Run atlas-in-space: survey every plane, draw them, write the proofs."""

from __future__ import annotations

from typing import Any

import numpy as np
import orjson

from safestart.atlas.plane_atlas import PlaneAtlas, build_on_plane
from safestart.exact.space.prove import proof_in_space
from safestart.processes.atlas_in_space.plots import polygons
from safestart.processes.atlas_in_space.spec import AtlasInSpaceInputs
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.start_in_space.plane import plane_of
from safestart.processes.start_in_space.plane_input import PlaneInput, coordinate_planes
from safestart.processes.start_in_space.question import stay_in
from safestart.runtime.progress import Context


def run(inputs: AtlasInSpaceInputs, context: Context) -> ProcessOutput:
    """Build an atlas of every plane."""
    question = stay_in(inputs, inputs.horizon_s)
    asked = inputs.planes or coordinate_planes(inputs.centre_m, inputs.size_m, inputs.rest)
    planes = [plane_of(said, question, f"planes.{k}") for k, said in enumerate(asked)]
    found: list[PlaneAtlas] = []
    for k, plane in enumerate(planes):
        part = context.part(float(k), 1.0, float(len(planes)), asked[k].name)
        count = 0

        def step(part: Context = part) -> None:
            nonlocal count
            count = min(count + 1, inputs.most_questions)
            part.step(count, inputs.most_questions, "questions")

        found.append(build_on_plane(question, plane, inputs.gap, inputs.most_questions, step))
        context.step(k + 1, len(planes), f"{asked[k].name} done")
    artifacts: list[Any] = [polygons(asked, found)]
    if inputs.proofs:
        documents = {said.name: _proofs(atlas) for said, atlas in zip(asked, found, strict=True)}
        artifacts.append(Artifact("proofs.json", "application/json", orjson.dumps(documents)))
    rows = [_row(said, atlas) for said, atlas in zip(asked, found, strict=True)]
    return ProcessOutput({"planes": rows}, tuple(artifacts))


def _row(said: PlaneInput, atlas: PlaneAtlas) -> dict[str, Any]:
    deepest = atlas.deepest
    return {
        "name": said.name,
        "axes": list(said.labels()),
        "inner_area": atlas.inner_area,
        "outer_area": atlas.outer_area,
        "relative_gap": atlas.relative_gap,
        "deepest_start": None if deepest is None else deepest.point.tolist(),
        "deepest_margin_m": None if deepest is None else deepest.margin,
        "inner_polygon": atlas.inner.tolist(),
        "outer_polygon": atlas.outer.tolist(),
        "half_planes": [[*bound.slope.tolist(), bound.level] for bound in atlas.bounds],
        "questions": atlas.asked,
        "message": atlas.message,
    }


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
