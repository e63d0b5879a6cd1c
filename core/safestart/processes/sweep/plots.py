"""Pictures of a sweep: confusion matrices, Table 3 as shares, the worst flights in the body frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from safestart.model.scenario import Floats
from safestart.processes.plotting import draw_corridor, drawn_as, figure
from safestart.processes.sweep.controllers import CONTROLLERS
from safestart.processes.sweep.inputs import SweepInputs

Path = tuple[dict[str, Any], Floats, Floats]
"""A worst case with the times (T,) and body-frame positions (T, 2) of its flight."""
NAMES = {
    "certified": "certified",
    "paper": "paper (not sound)",
    "exact": "exact",
    **{one.name: one.title for one in CONTROLLERS.values()},
}
_SAFE, _LOST = "#0072B2", "#D55E00"


@drawn_as("confusion.png")
def confusion_picture(inputs: SweepInputs, confusion: Mapping[str, Mapping[str, Any]]) -> Figure:
    """One 2 x 2 matrix per certificate (rows) and controller (columns)."""
    lines, columns = max(1, len(confusion)), len(inputs.controllers)
    drawing = figure(2.9 * columns + 0.6, 2.7 * lines + 0.7)
    axes = drawing.subplots(lines, columns, squeeze=False)
    for line, (certificate, cells) in zip(axes, confusion.items(), strict=False):
        for panel, (name, cell) in zip(line, cells.items(), strict=True):
            _matrix(panel, cell)
            panel.set_title(f"{NAMES[certificate]} / {NAMES[name]}", fontsize=10)
    drawing.suptitle("certified (rows) against\nflown without violation (columns)", fontsize=10)
    return drawing


def _matrix(panel: Axes, cell: Mapping[str, Any]) -> None:
    counts = np.array([[cell["tp"], cell["fp"]], [cell["fn"], cell["tn"]]])
    total = max(1, int(counts.sum()))
    right = np.array([[True, False], [False, True]])
    for i in range(2):
        for k in range(2):
            strength = 0.12 + 0.6 * counts[i, k] / total if counts[i, k] else 0.0
            colour = _SAFE if right[i, k] else _LOST
            panel.fill([k, k + 1, k + 1, k], [1 - i, 1 - i, 2 - i, 2 - i], color=colour, alpha=strength)
            panel.text(k + 0.5, 1.5 - i, f"{counts[i, k]:,}", ha="center", va="center", fontsize=12)
    panel.set_xlim(0, 2)
    panel.set_ylim(0, 2)
    panel.set_xticks([0.5, 1.5], ["stayed", "left"])
    panel.set_yticks([1.5, 0.5], ["certified", "not\ncertified"])
    panel.tick_params(length=0)
    rates = [("precision", cell["precision"]), ("recall", cell["recall"])]
    panel.set_xlabel(
        "   ".join(f"{name} {'-' if v is None else f'{v:.3f}'}" for name, v in rates), fontsize=9
    )


@drawn_as("table.png")
def table_picture(inputs: SweepInputs, cells: Sequence[Mapping[str, Any]]) -> Figure:
    """Share of starts certified and flown, per range (panels down), over tumble rate and thrust."""
    columns: list[tuple[str, str]] = [("certified", name) for name in inputs.certificates]
    columns += [("feasible", name) for name in inputs.controllers]
    rates, thrusts, ranges = inputs.omega_t_deg_s, inputs.a_max_m_s2, inputs.r0_m
    drawing = figure(
        1.1 + len(columns) * (0.8 + 0.33 * len(rates)), 1.0 + len(ranges) * (0.5 + 0.3 * len(thrusts))
    )
    axes = drawing.subplots(len(ranges), len(columns), squeeze=False, sharex=True, sharey=True)
    image: Any = None
    for line, r0 in zip(axes, ranges, strict=True):
        for panel, (kind, name) in zip(line, columns, strict=True):
            share = np.full((len(thrusts), len(rates)), np.nan)
            for cell in cells:
                if cell["r0_m"] == r0:
                    where = thrusts.index(cell["a_max_m_s2"]), rates.index(cell["omega_t_deg_s"])
                    share[where] = cell[kind][name] / cell["cases"]
            image = panel.imshow(share, vmin=0, vmax=1, cmap="viridis", aspect="auto", origin="lower")
            panel.set_xticks(range(len(rates)), [f"{rate:g}" for rate in rates], fontsize=8)
            panel.set_yticks(range(len(thrusts)), [f"{thrust:g}" for thrust in thrusts], fontsize=8)
        line[0].set_ylabel(f"{r0:g} m\na_max [m/s²]", fontsize=9)
    for panel, (kind, name) in zip(axes[0], columns, strict=True):
        panel.set_title(f"{'certified' if kind == 'certified' else 'flown'}:\n{NAMES[name]}", fontsize=9)
    for panel in axes[-1]:
        panel.set_xlabel("tumble rate [deg/s]", fontsize=9)
    drawing.colorbar(image, ax=axes, label="share of the starts", shrink=0.8)
    return drawing


@drawn_as("worst.png")
def worst_picture(inputs: SweepInputs, paths: Mapping[str, Sequence[Path]]) -> Figure:
    """The kept flights of each controller in the body frame; a cross marks a violation."""
    shown = {name: flights for name, flights in paths.items() if flights}
    drawing = figure(4.8 * len(shown), 2.9)
    axes = drawing.subplots(1, len(shown), squeeze=False)[0]
    shape = inputs.corridor.shape()
    for panel, (name, flights) in zip(axes, shown.items(), strict=True):
        reach = max(float(np.abs(body).max()) for _, _, body in flights)
        draw_corridor(panel, shape, max(1.08 * reach, 4.0 * shape.hold_radius))
        for case, _, body in flights:
            lost = case["violated_at_s"] is not None
            colour = _LOST if lost else _SAFE
            panel.plot(body[:, 0], body[:, 1], color=colour, linewidth=1.2)
            panel.plot(*body[0], marker="o", markersize=4, color=colour)
            if lost:
                panel.plot(*body[-1], marker="x", markersize=8, markeredgewidth=2, color=colour)
        lost_count = sum(case["violated_at_s"] is not None for case, _, _ in flights)
        panel.set_title(f"{NAMES[name]}: {len(flights)} worst certified, {lost_count} lost", fontsize=10)
    return drawing
