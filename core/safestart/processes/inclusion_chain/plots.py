"""Pictures of the chain: the nested sets on one map, and the table of violations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from safestart.engines.base import ResultCode
from safestart.engines.registry import engine_spec
from safestart.engines.spec import LineStyle
from safestart.model.scenario import Floats
from safestart.processes.inclusion_chain.regions import Region
from safestart.processes.inclusion_chain.spec import CHAIN, PAPER_CHAIN, ChainInputs
from safestart.processes.plotting import draw_corridor, drawn_as, figure

_LABELS = {
    "tube": "S_tube (stays, disturbed)",
    "analytical_tube": "paper's, tightened (not sound)",
    "certified": "S_certified (sound)",
    "analytical": "S_ana (paper's, not sound)",
    "synchronize": "S_sync (reach and co-rotate)",
    "stay": "stays, undisturbed",
    "hj_match": "HJ, velocity-aware",
    "hj_position": "S_HJpos (tube)",
    "exact_position": "position, exact at T",
}
# Colours of Okabe and Ito, distinct for colour-blind readers; line styles differ too.
_STYLES: dict[str, tuple[str, LineStyle]] = {
    "hj_position": ("#999999", "-"),
    "exact_position": (engine_spec("exact").colour, ":"),
    "stay": ("#CC79A7", "--"),
    "tube": ("#0072B2", "-"),
    "hj_match": (engine_spec("hamilton_jacobi").colour, "-."),
    "synchronize": ("#882255", "-"),
    "analytical_tube": (engine_spec("analytical").colour, ":"),
    "analytical": (engine_spec("analytical").colour, "--"),
    "certified": (engine_spec("certified").colour, "-"),
}
_FILLED = ("hj_position", "tube", "synchronize", "certified")
_FULL = LinearSegmentedColormap.from_list("violation", ["#FFFFFF", "#FBE3CF", "#E68A45", "#B04A00"])


@drawn_as("sets.png")
def chain_map(inputs: ChainInputs, regions: Mapping[str, Region], document: Mapping[str, Any]) -> Figure:
    """Sets of eq. (12) filled and outlined, the others as outlines; crosses where a link of the chain fails."""
    scenario, grid = inputs.scenario(), inputs.grid.grid()
    shape = scenario.corridor
    drawing = figure(9.0, 5.2)
    axes = drawing.subplots()
    outline = draw_corridor(axes, shape, grid.y_max)
    x, y = grid.axes(shape)
    handles: list[Line2D | Patch] = []
    for name, (colour, style) in _STYLES.items():
        region = regions.get(name)
        if region is None or region.code is not ResultCode.OK:
            continue
        cells = int(region.inside.sum())
        label = f"{_LABELS[name]}: {cells} cells"
        width = 2.0 if name in CHAIN + PAPER_CHAIN else 1.4
        if cells:
            level = _level(region)
            if name in _FILLED:
                axes.contourf(x, y, level, levels=[0.0, np.inf], colors=[colour], alpha=0.22).set_clip_path(
                    outline
                )
            line = axes.contour(
                x, y, level, levels=[0.0], colors=[colour], linestyles=[style], linewidths=width
            )
            line.set_clip_path(outline)
        handles.append(Line2D([], [], color=colour, linestyle=style, linewidth=width, label=label))
    links = {(link["inner"], link["outer"]) for link in document["chain"]}
    wrong = [e for e in document["counter_examples"] if (e["inner"], e["outer"]) in links]
    for example in wrong:
        axes.plot(
            example["x_m"], example["y_m"], "x", color="black", markersize=9, markeredgewidth=2, zorder=6
        )
    if wrong:
        handles.append(
            Line2D([], [], color="black", marker="x", linestyle="none", markersize=8, label="counter-example")
        )
    limit = scenario.sync_radius
    if math.isfinite(limit):
        axes.add_patch(Circle((0, 0), limit, fill=False, color="#333333", linestyle=(0, (1, 2)), linewidth=1))
        handles.append(
            Line2D([], [], color="#333333", linestyle=(0, (1, 2)), label=f"r_sync = {limit:.1f} m")
        )
    axes.set_title(f"Safe-start sets at {_point(inputs)}", fontsize=11)
    drawing.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    return drawing


@drawn_as("violations.png")
def violation_table(
    inputs: ChainInputs, regions: Mapping[str, Region], document: Mapping[str, Any]
) -> Figure:
    """Matrix of violation fractions in percent; the links that eq. (12) claims to be 0 are framed."""
    names = list(regions)
    table = np.array([[document["violation_fraction"][a][b] for b in names] for a in names], dtype=np.float64)
    size = 0.85 * len(names)
    drawing = figure(size + 3.4, size + 2.2)
    axes = drawing.subplots()
    shown = axes.imshow(np.ma.masked_invalid(100.0 * table), cmap=_FULL, vmin=0.0, vmax=100.0)
    for i, j in np.ndindex(table.shape):
        value = float(table[i, j])
        text = "-" if not np.isfinite(value) else "·" if i == j else _percent(100.0 * value)
        colour = "white" if np.isfinite(value) and value > 0.75 else "black"
        axes.text(j, i, text, ha="center", va="center", fontsize=9, color=colour)
    for link in document["chain"]:
        i, j = names.index(link["inner"]), names.index(link["outer"])
        axes.plot(
            [j - 0.47, j + 0.47, j + 0.47, j - 0.47, j - 0.47],
            [i - 0.47, i - 0.47, i + 0.47, i + 0.47, i - 0.47],
            color="#0072B2",
            linewidth=2.2,
        )
    axes.set_xticks(range(len(names)), names, rotation=35, ha="right")
    axes.set_yticks(range(len(names)), [f"{n} ({int(regions[n].inside.sum())})" for n in names])
    axes.set_xlabel("… that lie outside this set (blue frame: claimed to be 0)")
    axes.set_ylabel("cells of this set (count) …")
    axes.set_title(f"Violations of inclusion, %\n{_point(inputs)}", fontsize=11)
    drawing.colorbar(shown, ax=axes, shrink=0.75, label="% of the inner set's cells")
    return drawing


def _point(inputs: ChainInputs) -> str:
    return f"{inputs.omega_t_deg_s:g} deg/s, {inputs.a_max_m_s2:g} m/s², horizon {inputs.horizon_s:g} s"


def _percent(value: float) -> str:
    return "0" if value == 0.0 else "100" if value == 100.0 else f"{value:.1f}"


def _level(region: Region) -> Floats:
    """Field whose zero level outlines the cells: margins from several sources differ in scale, so +-0.5 per cell."""
    return np.where(region.inside, 0.5, -0.5)
