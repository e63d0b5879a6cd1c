"""Picture of an atlas: the closed form inside the proved GO polygon, the proved NO_GO region, the strip between."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon

from safestart.atlas.atlas import Atlas
from safestart.closed_form.by_name import ClosedForm, map_of
from safestart.engines.registry import engine_spec
from safestart.engines.spec import LineStyle
from safestart.model.scenario import Grid, Scenario
from safestart.processes.plotting import draw_corridor, drawn_as, figure

_GO, _NO_GO = "#56B4E9", "#E69F00"
_FINE = 400

_FORMS: tuple[tuple[ClosedForm, str, LineStyle], ...] = (
    ("certified", "certified", "-"),
    ("paper", "analytical", "--"),
)


@drawn_as("atlas.png")
def atlas_map(scenario: Scenario, grid: Grid, atlas: Atlas) -> Figure:
    """Polygon of proved GO, proved NO_GO, closed form as an outline, deepest start as a cross."""
    shape = scenario.corridor
    drawing = figure(8.6, 4.5)
    axes = drawing.subplots()
    outline = draw_corridor(axes, shape, grid.y_max)
    fine = Grid(_FINE, _FINE, grid.y_max)
    x, y = fine.axes(shape)
    _, upper = atlas.bounds(fine.points(shape))
    axes.contourf(x, y, upper, levels=[-np.inf, 0.0], colors=[_NO_GO], alpha=0.35).set_clip_path(outline)
    if len(atlas.rim) >= 3:
        corners = np.array([witness.start for witness in atlas.rim])
        axes.add_patch(
            Polygon(corners, facecolor=_GO, alpha=0.75, edgecolor=engine_spec("exact").colour, linewidth=1.2)
        )
        axes.plot(*atlas.deepest.start, marker="+", color="black", markersize=9, linestyle="none")
    for form, engine, style in _FORMS:
        margin, colour = map_of(form, scenario, fine).margin, engine_spec(engine).colour
        line = axes.contour(x, y, margin, levels=[0.0], colors=[colour], linestyles=[style], linewidths=2.0)
        line.set_clip_path(outline)
    share = f"{100 * atlas.relative_gap:.2f} %"
    drawing.legend(
        handles=[
            Patch(color=_GO, alpha=0.75, label=f"GO, proved: {atlas.inner_area:.0f} m²"),
            Patch(color=_NO_GO, alpha=0.35, label=f"NO_GO, proved (undecided between: {share})"),
            *(
                Line2D(
                    [],
                    [],
                    color=engine_spec(engine).colour,
                    linestyle=style,
                    linewidth=2,
                    label=engine_spec(engine).title,
                )
                for _, engine, style in _FORMS
            ),
            Line2D(
                [],
                [],
                color="black",
                marker="+",
                linestyle="none",
                label=f"deepest: {atlas.deepest.margin:.1f} m",
            ),
        ],
        loc="outside lower center",
        ncols=2,
        frameon=False,
        fontsize=9,
    )
    rate, thrust = math.degrees(scenario.target.tumble_rate), scenario.chaser.max_acceleration
    axes.set_title(
        f"Starts at rest that can stay {atlas.question.horizon:g} s: {rate:g} deg/s, {thrust:g} m/s²"
    )
    return drawing
