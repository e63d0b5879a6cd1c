"""Picture of a sweep in space: the exact margin of every start against the margin that its flight kept."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from safestart.exact.answer import Verdict
from safestart.processes.plotting import drawn_as, figure

_GROUPS = (
    (Verdict.GO, "exact GO", "#009E73", "o"),
    (Verdict.NO_GO, "exact NO_GO", "#D55E00", "x"),
    (Verdict.UNDECIDED, "exact undecided", "#888888", "s"),
)


@drawn_as("margins.png")
def margins(rows: Sequence[dict[str, Any]]) -> Figure:
    """Below zero a flight has left the faces; a start without a proved margin stands at zero."""
    drawing = figure(7.0, 4.6)
    axes = drawing.subplots()
    axes.axhline(0.0, color="#444444", linewidth=1.0)
    axes.axvline(0.0, color="#BBBBBB", linewidth=0.8)
    for verdict, label, colour, marker in _GROUPS:
        chosen = [row for row in rows if row["exact"] == verdict.value]
        if not chosen:
            continue
        lost = sum(row["flown_margin_m"] < 0.0 for row in chosen)
        axes.scatter(
            [row["exact_margin_m"] or 0.0 for row in chosen],
            [row["flown_margin_m"] for row in chosen],
            s=22,
            color=colour,
            marker=marker,
            label=f"{label}: {len(chosen)}, of which {lost} left",
        )
    axes.set_xlabel("largest margin that any thrust keeps, proved bound [m]")
    axes.set_ylabel("margin that the flight kept [m]")
    axes.set_title("Every start: what is possible, and what the controller did", fontsize=10)
    if rows:
        axes.legend(loc="best", frameon=False, fontsize=9)
    else:
        axes.text(0.5, 0.5, "no start lies inside the faces", transform=axes.transAxes, ha="center")
    return drawing
