"""Run safe-region: the atlas of the operating point, clipped to the shown corridor."""

from __future__ import annotations

from typing import Any

import numpy as np

from safestart.constraints.corridor import corridor_of
from safestart.errors import invalid
from safestart.exact.question import Question
from safestart.model.scenario import Floats, Scenario
from safestart.processes.base import ProcessOutput
from safestart.processes.go_no_go.atlases import atlas_for
from safestart.processes.safe_region.spec import SafeRegionInputs
from safestart.processes.wire import DT_S
from safestart.runtime.progress import Context


def run(inputs: SafeRegionInputs, context: Context) -> ProcessOutput:
    """Find or build the atlas and clip its two polygons."""
    found = region_of(inputs.scenario(), inputs.horizon_s, inputs.y_max_m, context)
    context.step(1, 1)
    return ProcessOutput(found)


def region_of(scenario: Scenario, horizon_s: float, y_max: float, context: Context) -> dict[str, Any]:
    """The outputs for a corridor cut at ``y_max`` metres; see :class:`SafeRegionOutputs`."""
    shape = scenario.corridor
    if y_max <= shape.hold_radius:
        raise invalid("y_max_m", f"more than corridor.r_h_m, {shape.hold_radius:g}", y_max)
    question = Question(scenario, DT_S, round(horizon_s / DT_S))
    atlas = atlas_for(question, y_max, context)
    assert atlas is not None  # built if none existed
    corridor = corridor_of(shape)
    half = shape.x0 + shape.c_x * (y_max - shape.hold_radius)
    box = np.array(
        [
            [-half, shape.hold_radius],
            [half, shape.hold_radius],
            [half, y_max],
            [-half, y_max],
        ]
    )
    outer = box
    for normal, offset in zip(corridor.normals, corridor.offsets, strict=True):
        outer = clip(outer, -normal, float(offset))
    for slope, level in zip(atlas.slopes, atlas.levels, strict=True):
        outer = clip(outer, slope, float(level))
    inner = np.array([witness.start for witness in atlas.rim]).reshape(-1, 2)
    inner = clip(inner, np.array([0.0, -1.0]), y_max) if len(inner) >= 3 else np.empty((0, 2))
    return {
        "inner_polygon_m": inner.tolist(),
        "outer_polygon_m": outer.tolist(),
        "inner_area_m2": area(inner),
        "outer_area_m2": area(outer),
        "deepest_start_m": atlas.deepest.start.tolist(),
        "deepest_margin_m": atlas.deepest.margin,
        "message": atlas.message,
    }


def clip(polygon: Floats, slope: Floats, level: float) -> Floats:
    """The part of a convex polygon (K, 2) where slope . p + level >= 0."""
    if len(polygon) == 0:
        return polygon
    value = polygon @ slope + level
    kept: list[Floats] = []
    for here, there, a, b in zip(
        polygon, np.roll(polygon, -1, axis=0), value, np.roll(value, -1), strict=True
    ):
        if a >= 0.0:
            kept.append(here)
        if a * b < 0.0:
            kept.append(here + (there - here) * (a / (a - b)))
    return np.array(kept).reshape(-1, 2)


def area(polygon: Floats) -> float:
    """Area of a polygon (K, 2) counter-clockwise; 0 with fewer than three corners."""
    if len(polygon) < 3:
        return 0.0
    x, y = polygon.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
