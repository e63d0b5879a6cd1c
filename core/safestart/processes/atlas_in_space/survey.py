"""The atlases of the planes that a request asks for, and their rows: without pictures, for answers at once too."""

from __future__ import annotations

from typing import Any

from safestart.atlas.plane_atlas import PlaneAtlas, build_on_plane
from safestart.processes.atlas_in_space.spec import PlanesAsked
from safestart.processes.start_in_space.plane import plane_of
from safestart.processes.start_in_space.plane_input import PlaneInput
from safestart.processes.start_in_space.question import stay_in
from safestart.runtime.progress import Context


def survey(inputs: PlanesAsked, context: Context) -> tuple[list[PlaneInput], list[PlaneAtlas]]:
    """The planes and their atlases."""
    question = stay_in(inputs, inputs.horizon_s)
    asked = inputs.asked()
    planes = [plane_of(said, question) for said in asked]
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
    return asked, found


def rows(asked: list[PlaneInput], found: list[PlaneAtlas]) -> list[dict[str, Any]]:
    """:class:`~safestart.processes.atlas_in_space.spec.PlanePolygons` of every plane."""
    return [_row(said, atlas) for said, atlas in zip(asked, found, strict=True)]


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
