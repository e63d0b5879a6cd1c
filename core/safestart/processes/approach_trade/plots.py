"""Picture of an approach trade: fuel against the proved error level and against the risk, the angle coloured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from safestart.processes.approach_trade.findings import UNSOLVABLE
from safestart.processes.approach_trade.spec import ApproachTradeInputs
from safestart.processes.plotting import drawn_as, figure

_MARKS = "osD^vPX*<>"
_MOST_LABELS = 24
_AWAY, _TIGHT = "#1F4E9E", "#8C2B1D"
Row = Mapping[str, Any]


@drawn_as("approach_trade.png")
def picture(inputs: ApproachTradeInputs, document: Mapping[str, Any]) -> Figure:
    """Left: fuel and error level with the front. Right: fuel and risk with its interval. Arrows: what remedies cost."""
    drawing = figure(12.5, 5.4)
    left, right = drawing.subplots(1, 2)
    rows = document["approaches"]
    shades = Normalize(min(inputs.angles_deg), max(*inputs.angles_deg, min(inputs.angles_deg) + 1.0))
    levels = [row["lambda"] for row in rows]
    points = _points(left, rows, levels, shades)
    front = document["front"]
    left.plot(
        [row["fuel_2norm_m_s"] for row in front],
        [row["lambda"] for row in front],
        color="#666666",
        linewidth=1.0,
        drawstyle="steps-post",
        zorder=1,
        label="front: less fuel or a higher level",
    )
    for row in rows:
        if row["away"] is not None:
            _arrow(
                left,
                row["fuel_2norm_m_s"],
                row["lambda"],
                row["away"]["fuel_2norm_m_s"],
                row["away"]["lambda"],
                _AWAY,
            )
    left.plot([], [], color=_AWAY, marker=">", markersize=4, label="least drift away")
    left.axhline(inputs.demand.error_level, color="#C0392B", linestyle="--", linewidth=1.0, label="demanded")
    left.set_ylabel("error level lambda that is proved")
    if min(levels, default=0.0) > 0.0:
        left.set_yscale("log")
    left.legend(fontsize=8, loc="best")
    _risks(right, inputs, rows, shades)
    for axes in (left, right):
        axes.set_xlabel("fuel, 2-norm [m/s]")
        axes.grid(alpha=0.3)
    drawing.colorbar(
        points, ax=right, label="angle [deg]; a ring: beyond 110 deg, where the paper sees no solution"
    )
    drawing.suptitle(
        f"Hopping approaches from {inputs.start_m:g} m: fuel against what is proved and against what flies",
        fontsize=11,
    )
    return drawing


def _points(axes: Axes, rows: Sequence[Row], heights: Sequence[float], shades: Normalize) -> Any:
    """Approaches; a mark for each pair of hops and hold point."""
    kinds = sorted({(row["hops"], row["hold_m"]) for row in rows})
    drawn = None
    for number, kind in enumerate(kinds):
        mine = [k for k, row in enumerate(rows) if (row["hops"], row["hold_m"]) == kind]
        beyond = [UNSOLVABLE[0] < rows[k]["angle_deg"] < UNSOLVABLE[1] for k in mine]
        drawn = axes.scatter(
            [rows[k]["fuel_2norm_m_s"] for k in mine],
            [heights[k] for k in mine],
            c=[rows[k]["angle_deg"] for k in mine],
            norm=shades,
            cmap="viridis",
            marker=_MARKS[number % len(_MARKS)],
            s=52,
            edgecolors=["#D55E00" if far else "#222222" for far in beyond],
            linewidths=[1.8 if far else 0.5 for far in beyond],
            zorder=3,
            label=f"{kind[0]} hops to {kind[1]:g} m" if len(kinds) > 1 else None,
        )
    if len(rows) <= _MOST_LABELS:
        for row, height in zip(rows, heights, strict=True):
            axes.annotate(
                f"{row['angle_deg']:g}°",
                (row["fuel_2norm_m_s"], height),
                xytext=(6, 5),
                textcoords="offset points",
                fontsize=8,
            )
    return drawn


def _risks(axes: Axes, inputs: ApproachTradeInputs, rows: Sequence[Row], shades: Normalize) -> None:
    least = 0.3 / inputs.runs
    shares = [max(row["breach"]["probability"], least) for row in rows]
    for row, share in zip(rows, shares, strict=True):
        low, high = max(row["breach"]["low"], least), row["breach"]["high"]
        axes.plot([row["fuel_2norm_m_s"]] * 2, [low, high], color="#777777", linewidth=1.2, zorder=1)
        tight = row["tightening"]
        if tight is not None:
            _arrow(axes, row["fuel_2norm_m_s"], share, tight["fuel_2norm_m_s"], tight["breach_high"], _TIGHT)
    _points(axes, rows, shares, shades)
    axes.plot([], [], color="#777777", label="interval of 95 %")
    axes.plot([], [], color=_TIGHT, marker=">", markersize=4, label="least tightening, upper end")
    axes.axhline(inputs.demand.breach, color="#C0392B", linestyle="--", linewidth=1.0, label="demanded")
    axes.set_yscale("log")
    axes.set_ylim(0.7 * least, 1.5)
    axes.set_ylabel(f"share of {inputs.runs} approaches with an abort breach (the floor: none)")
    axes.legend(fontsize=8, loc="best")


def _arrow(axes: Axes, x0: float, y0: float, x1: float, y1: float, colour: str) -> None:
    if np.isfinite([x0, y0, x1, y1]).all():
        axes.annotate(
            "",
            (x1, y1),
            (x0, y0),
            arrowprops={"arrowstyle": "->", "color": colour, "linewidth": 1.4},
            zorder=4,
        )
