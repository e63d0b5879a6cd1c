"""The picture of a commit timeline: a bar for each corridor, coloured by verdict."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure
from matplotlib.patches import Patch

from safestart.processes.plotting import drawn_as, figure

COLOURS = {"GO": "#009E73", "NO_GO": "#D55E00", "UNDECIDED": "#BBBBBB"}
_HATCHES = {"GO": "", "NO_GO": "//", "UNDECIDED": ".."}


@drawn_as("timeline.png")
def picture(document: dict[str, Any]) -> Figure:
    """Verdicts over time; an instant without neighbours of its verdict is a thin line."""
    intervals = document["intervals"]
    names = list(dict.fromkeys(one["corridor"] for one in intervals))
    longest = max(one["end_s"] for one in intervals)
    scale, unit = (3600.0, "h") if longest > 7200.0 else (60.0, "min") if longest > 240.0 else (1.0, "s")
    drawing = figure(10.0, 1.6 + 0.6 * len(names))
    axes = drawing.subplots()
    for row, name in enumerate(names):
        own = [one for one in intervals if one["corridor"] == name]
        for verdict, colour in COLOURS.items():
            bars = [
                (one["begin_s"] / scale, max(one["end_s"] - one["begin_s"], longest / 2000.0) / scale)
                for one in own
                if one["verdict"] == verdict
            ]
            hatch, edge = _HATCHES[verdict], "white" if _HATCHES[verdict] else colour
            axes.broken_barh(
                bars, (row - 0.35, 0.7), facecolor=colour, edgecolor=edge, linewidth=0.0, hatch=hatch
            )
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlim(0.0, max(longest, 1e-9) / scale)
    axes.set_xlabel(f"time since {document['start']} UTC [{unit}]")
    axes.set_title(f"May {document['chaser']} start its approach to {document['target']}?")
    handles = [
        Patch(facecolor=colour, edgecolor="white", hatch=_HATCHES[verdict], label=verdict.replace("_", " "))
        for verdict, colour in COLOURS.items()
    ]
    drawing.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    return drawing
