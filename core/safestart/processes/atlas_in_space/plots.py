"""Picture of an atlas in space: proved GO, proved NO_GO and the strip between, one panel for each plane."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.patches import Patch, Polygon

from safestart.atlas.plane_atlas import PlaneAtlas
from safestart.processes.plotting import drawn_as, figure
from safestart.processes.start_in_space.plane_input import PlaneInput

_GO, _NO_GO = "#56B4E9", "#E69F00"
_ACROSS = 3


@drawn_as("atlas.png")
def polygons(asked: Sequence[PlaneInput], found: Sequence[PlaneAtlas]) -> Figure:
    """Inner polygons on white strips on the proved NO_GO; the deepest start as a cross."""
    across = min(_ACROSS, len(found))
    down = math.ceil(len(found) / across)
    drawing = figure(4.4 * across, 4.3 * down + 0.4)
    panels = drawing.subplots(down, across, squeeze=False).ravel()
    for axes in panels[len(found) :]:
        axes.set_axis_off()
    for axes, said, atlas in zip(panels, asked, found, strict=False):
        axes.set_facecolor("#F7DFB0")
        if len(atlas.outer) >= 3:
            axes.add_patch(Polygon(atlas.outer, facecolor="white", edgecolor=_NO_GO, linewidth=1.2))
        if len(atlas.corners) >= 3:
            axes.add_patch(Polygon(atlas.inner, facecolor=_GO, edgecolor="#1F6F9F", linewidth=1.0))
        if atlas.deepest is not None:
            axes.plot(*atlas.deepest.point, marker="+", color="black", markersize=9)
        low, high = atlas.plane.low, atlas.plane.high
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        if said.first.kind == said.second.kind:
            axes.set_aspect("equal")
        first, second = said.labels()
        axes.set_xlabel(first)
        axes.set_ylabel(second)
        title = (
            "no start stays"
            if atlas.deepest is None
            else f"at best {atlas.deepest.margin:.1f} m to every face"
        )
        axes.set_title(f"{said.name}: {title}", fontsize=10)
    handles = [
        Patch(facecolor=_GO, label="GO, proved"),
        Patch(facecolor="#F7DFB0", edgecolor=_NO_GO, label="NO_GO, proved"),
        Patch(facecolor="white", edgecolor="#888888", label="undecided"),
    ]
    drawing.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    return drawing
