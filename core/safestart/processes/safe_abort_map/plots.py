"""Picture and arrays of a safe-abort map."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure

from safestart.model.scenario import Floats
from safestart.passive_safety.switching_guard import Guard
from safestart.processes.passive_safety.plots import frame
from safestart.processes.plotting import drawn_as, figure
from safestart.processes.safe_abort_map.spec import SafeAbortMapInputs

_STEPS = 12


def arrays(document: dict[str, Any]) -> dict[str, Floats]:
    """Starts (N,) in m and both limits (N,) in min, NaN without a limit."""
    names = ("x_m", "y_m", "safe_abort_until_min", "all_proved_until_min")
    return {name: np.array(document[name], dtype=np.float64) for name in names}


@drawn_as("map.png")
def map_picture(inputs: SafeAbortMapInputs, document: dict[str, Any]) -> Figure:
    """Passive safety alone, and with every requirement: colour is the time up to which it is proved."""
    values = arrays(document)
    boxes = _boxes(inputs, document)
    drawing = figure(11.0, 5.4)
    axes: tuple[Axes, Axes] = drawing.subplots(1, 2, sharex=True, sharey=True)
    levels = np.linspace(0.0, inputs.last_abort_min, _STEPS + 1)
    colours = mpl.colormaps["viridis"].resampled(_STEPS).with_extremes(bad="#D9D9D9")
    panels = (
        ("safe_abort_until_min", "drift proved apart from the target"),
        ("all_proved_until_min", "and thrust, line of sight, speed proved until then"),
    )
    for place, (name, title) in zip(axes, panels, strict=True):
        shown = PolyCollection(
            list(boxes),
            array=np.ma.masked_invalid(values[name]),
            cmap=colours,
            norm=BoundaryNorm(levels, _STEPS),
        )
        shown.set_edgecolor("face")
        shown.set_linewidth(1.0)  # so that a small box stays visible
        place.add_collection(shown, autolim=True)
        frame(place, Guard(inputs.guard))
        place.autoscale_view()
        place.set_title(title, fontsize=10)
    axes[1].set_ylabel("")
    bar = drawing.colorbar(shown, ax=list(axes), shrink=0.85, ticks=levels[::2])
    bar.set_label("every abort until then is proved safe [min]")
    what = f"{inputs.model} dynamics, {inputs.gains} gains, guard {inputs.guard}"
    grey = "; grey: no start" if np.isnan(values["safe_abort_until_min"]).any() else ""
    drawing.suptitle(
        f"Safe-abort map, box of half-width {inputs.box_half_width_m:g} m ({what}{grey})\n"
        f"each mark is one start, proved for ±{inputs.half_width_m:g} m around it and not for what lies between",
        fontsize=11,
    )
    return drawing


def _boxes(inputs: SafeAbortMapInputs, document: dict[str, Any]) -> Floats:
    """Corners (N, 4, 2) of the box of each start, which is all that the proofs cover."""
    half = inputs.half_width_m
    places = np.stack([np.array(document["x_m"]), np.array(document["y_m"])], axis=-1).reshape(-1, 1, 2)
    corners: Floats = places + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    return corners
