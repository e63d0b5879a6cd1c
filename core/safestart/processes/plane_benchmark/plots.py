"""Picture of the engines' sets on one plane of starts."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from safestart.engines.base import EngineResult
from safestart.engines.registry import engine_spec
from safestart.model.scenario import Bools, Floats
from safestart.processes.plotting import drawn_as, figure


@drawn_as("overlay.png")
def overlay(
    labels: tuple[str, str], axes: tuple[Floats, Floats], inside: Bools, results: Mapping[str, EngineResult]
) -> Figure:
    """The starts inside all faces in grey, the exact set filled, the others as outlines."""
    drawing = figure(7.0, 5.4)
    plot = drawing.subplots()
    a, b = axes
    handles: list[Patch | Line2D] = [Patch(color="#E4E4E4", label="inside all faces at t = 0")]
    plot.contourf(a, b, inside.astype(np.float64), levels=[0.5, 1.5], colors=["#E4E4E4"])
    for name, result in results.items():
        if result.mask is None:
            continue
        spec, mask = engine_spec(name), result.mask.astype(np.float64)
        if name == "exact":
            plot.contourf(a, b, mask, levels=[0.5, 1.5], colors=["#8FB6E8"])
            handles.append(Patch(color="#8FB6E8", label=spec.title))
        elif mask.min() < mask.max():
            style = spec.line or "-"
            plot.contour(a, b, mask, levels=[0.5], colors=[spec.colour], linestyles=[style])
            handles.append(Line2D([], [], color=spec.colour, linestyle=style, label=spec.title))
    plot.set_xlabel(labels[0])
    plot.set_ylabel(labels[1])
    drawing.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    return drawing
