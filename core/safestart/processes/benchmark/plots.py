"""Pictures of a benchmark: all regions on one map, and each engine against the exact set."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from safestart.engines.base import EngineResult, Problem
from safestart.engines.registry import engine_spec
from safestart.model.scenario import Floats
from safestart.processes.plotting import draw_corridor, drawn_as, figure

_BOTH, _ONLY_ENGINE, _ONLY_REFERENCE = "#009E73", "#D55E00", "#0072B2"


def _title(problem: Problem) -> str:
    s = problem.scenario
    return (
        f"{math.degrees(s.target.tumble_rate):g} deg/s, {s.chaser.max_acceleration:g} m/s², "
        f"{problem.kind.value} set at {problem.horizon:g} s, rest in {problem.rest.value.upper()}"
    )


@drawn_as("overlay.png")
def overlay_map(problem: Problem, results: Mapping[str, EngineResult]) -> Figure:
    """Certificate filled, the other engines as outlines, the range limit as a circle."""
    shape = problem.scenario.corridor
    drawing = figure(8.6, 4.5)
    axes = drawing.subplots()
    outline = draw_corridor(axes, shape, problem.grid.y_max)
    x, y = problem.grid.axes(shape)
    handles: list[Line2D | Patch] = []
    for name, result in results.items():
        if result.mask is None:
            continue
        spec = engine_spec(name)
        label = f"{spec.title}: {np.count_nonzero(result.mask)} cells"
        if not result.mask.any():
            handles.append(Line2D([], [], color="none", label=label))
        elif spec.line is None:
            drawn = axes.contourf(
                x, y, _level(result), levels=[0.0, np.inf], colors=[spec.colour], alpha=0.75
            )
            drawn.set_clip_path(outline)
            handles.append(Patch(color=spec.colour, alpha=0.75, label=label))
        else:
            style, colour = spec.line, spec.colour
            line = axes.contour(
                x, y, _level(result), levels=[0.0], colors=[colour], linestyles=[style], linewidths=1.8
            )
            line.set_clip_path(outline)
            handles.append(Line2D([], [], color=colour, linestyle=style, linewidth=1.8, label=label))
    limit = problem.scenario.sync_radius
    if math.isfinite(limit):
        axes.add_patch(
            Circle((0, 0), limit, fill=False, color="#333333", linestyle=(0, (1, 2)), linewidth=1.0)
        )
        handles.append(
            Line2D([], [], color="#333333", linestyle=(0, (1, 2)), label=f"r_sync = {limit:.1f} m")
        )
    axes.set_title(_title(problem), fontsize=11)
    drawing.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    return drawing


def _level(result: EngineResult) -> Floats:
    """Field whose zero level outlines the region: the margin, or +-0.5 per cell without a margin."""
    assert result.mask is not None
    return np.where(result.mask, 0.5, -0.5) if result.margin is None else result.margin


@drawn_as("agreement.png")
def agreement_panels(problem: Problem, results: Mapping[str, EngineResult]) -> Figure:
    """One panel per engine: cells in both sets, in the engine's only, in the reference's only."""
    reference = next(
        (n for n in ("exact", "hamilton_jacobi") if n in results and results[n].mask is not None), None
    )
    names = [n for n, r in results.items() if r.mask is not None and n != reference]
    columns = max(1, min(3, len(names)))
    lines = max(1, -(-len(names) // columns))
    drawing = figure(4.3 * columns, 1.9 * lines + 0.9)
    panels = drawing.subplots(lines, columns, squeeze=False)
    for panel, name in zip(panels.flat, names, strict=False):
        _panel(panel, problem, results[name], results[reference] if reference else None)
        panel.set_title(engine_spec(name).title, fontsize=10)
    for panel in panels.flat[len(names) :]:
        panel.set_axis_off()
    against = engine_spec(reference).title if reference else "nothing"
    drawing.legend(
        handles=[
            Patch(color=_BOTH, label="in both"),
            Patch(color=_ONLY_ENGINE, label="only in the engine's set"),
            Patch(color=_ONLY_REFERENCE, label=f"only in {against}"),
        ],
        loc="outside lower center",
        ncols=3,
        frameon=False,
        fontsize=9,
    )
    drawing.suptitle(f"Each engine against {against}: {_title(problem)}", fontsize=11)
    return drawing


def _panel(axes: Axes, problem: Problem, result: EngineResult, reference: EngineResult | None) -> None:
    shape = problem.scenario.corridor
    draw_corridor(axes, shape, problem.grid.y_max)
    x, y = problem.grid.axes(shape)
    mask = result.mask
    assert mask is not None
    other = reference.mask if reference is not None and reference.mask is not None else mask
    code = np.where(mask & other, 1, np.where(mask, 2, np.where(other, 3, 0))).astype(float)
    cells = np.ma.masked_equal(code, 0)
    colours = ListedColormap([_BOTH, _ONLY_ENGINE, _ONLY_REFERENCE])
    axes.pcolormesh(x, y, cells, cmap=colours, vmin=0.5, vmax=3.5, shading="nearest", alpha=0.85)
