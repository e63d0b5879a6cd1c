"""Run atlas: build it, answer the grid with it, draw it."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.atlas.atlas import Atlas
from safestart.atlas.file import key_of, pack
from safestart.atlas.survey import build
from safestart.closed_form.paper import certify_grid
from safestart.errors import invalid
from safestart.exact.question import Question
from safestart.model.scenario import Floats
from safestart.processes.atlas.plots import atlas_map
from safestart.processes.atlas.spec import AtlasInputs
from safestart.processes.base import Artifact, ProcessOutput
from safestart.processes.plotting import NPZ, npz
from safestart.runtime.progress import Context


def run(inputs: AtlasInputs, context: Context) -> ProcessOutput:
    """Build the atlas and bracket the margin of every cell of the grid."""
    scenario, grid = inputs.scenario(), inputs.grid.grid()
    steps = round(inputs.horizon_s / inputs.dt_s)
    if abs(steps * inputs.dt_s - inputs.horizon_s) > 1e-9 * inputs.horizon_s:
        raise invalid("horizon_s", f"a whole number of intervals of {inputs.dt_s:g} s", inputs.horizon_s)
    points = grid.points(scenario.corridor)
    context.step(0, 3, "directions")
    question = Question(scenario, inputs.dt_s, steps)
    key = key_of(question, grid.y_max, inputs.gap)
    atlas = build(question, grid.y_max, inputs.gap)
    context.step(1, 3, "cells")
    lower, upper = atlas.bounds(points)
    region = certify_grid(scenario, grid)
    context.step(2, 3, "picture")
    go, no_go = (lower > 0.0) & region.inside, (upper < 0.0) & region.inside
    document: dict[str, Any] = {
        "inner_area_m2": atlas.inner_area,
        "outer_area_m2": atlas.outer_area,
        "relative_gap": atlas.relative_gap,
        "deepest_start_m": atlas.deepest.start.tolist(),
        "deepest_margin_m": atlas.deepest.margin,
        "inner_polygon_m": [witness.start.tolist() for witness in atlas.rim],
        "half_planes": np.column_stack([atlas.slopes, atlas.levels]).tolist(),
        "verdict_cells": {
            "GO": int(go.sum()),
            "NO_GO": int(no_go.sum()),
            "UNDECIDED": int((region.inside & ~go & ~no_go).sum()),
        },
        "certified_outside": int((region.mask & no_go).sum()),
        "message": atlas.message,
    }
    picture = atlas_map(scenario, grid, atlas)
    proofs = Artifact("proofs.npz", NPZ, pack(atlas), key)
    return ProcessOutput(document, (picture, _arrays(atlas, points, lower, upper), proofs))


def _arrays(atlas: Atlas, points: Floats, lower: Floats, upper: Floats) -> Artifact:
    return npz(
        "atlas.npz",
        {
            "points_m": points,
            "margin_lower_m": lower,
            "margin_upper_m": upper,
            "inner_polygon_m": np.array([w.start for w in atlas.rim]).reshape(-1, 2),
            "half_plane_slope": atlas.slopes,
            "half_plane_level_m": atlas.levels,
        },
    )
