"""Picture of coverage: nested certified regions per thrust level, one panel per tumble rate (Fig. 3)."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from safestart.closed_form.by_name import ClosedForm
from safestart.model.scenario import Bools, CorridorShape, Grid
from safestart.processes.plotting import draw_corridor, drawn_as, figure

_TITLES: dict[ClosedForm, str] = {
    "certified": "certified start at rest, by thrust",
    "paper": "start at rest that meets the paper's conditions (not sound), by thrust",
}
_MAX_PANELS = 6
_MAX_LEVELS = 6


@drawn_as("coverage.png")
def coverage_map(
    name: ClosedForm,
    shape: CorridorShape,
    grid: Grid,
    rates: Sequence[float],
    thrusts: Sequence[float],
    masks: Bools,
) -> Figure:
    """Panels of at most six tumble rates, spread over the list; the least thrust is drawn last, on top."""
    panels = _spread(len(rates), _MAX_PANELS)
    levels = sorted(_spread(len(thrusts), _MAX_LEVELS), key=lambda k: -thrusts[k])
    colours = mpl.colormaps["viridis"](np.linspace(0.92, 0.12, len(levels)))
    columns = min(3, len(panels))
    lines = -(-len(panels) // columns)
    drawing = figure(4.3 * columns, 1.9 * lines + 0.9)
    axes = drawing.subplots(lines, columns, squeeze=False)
    x, y = grid.axes(shape)
    for panel, i in zip(axes.flat, panels, strict=False):
        draw_corridor(panel, shape, grid.y_max)
        panel.set_title(f"{rates[i]:g} deg/s", fontsize=10)
        for colour, k in zip(colours, levels, strict=True):
            if masks[i, k].any():
                panel.contourf(x, y, masks[i, k].astype(float), levels=[0.5, 1.5], colors=[colour])
    for panel in axes.flat[len(panels) :]:
        panel.set_axis_off()
    drawing.legend(
        handles=[Patch(color=c, label=f"{thrusts[k]:g} m/s²") for c, k in zip(colours, levels, strict=True)],
        title=_TITLES[name],
        loc="outside lower center",
        ncols=len(levels),
        frameon=False,
    )
    return drawing


def _spread(count: int, most: int) -> list[int]:
    """Indices of at most ``most`` entries, first and last included."""
    return sorted({round(v) for v in np.linspace(0, count - 1, min(count, most))})
