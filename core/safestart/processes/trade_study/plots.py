"""Heat maps of a trade study, values written into the cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from safestart.processes.plotting import drawn_as, figure
from safestart.processes.trade_study.spec import TradeStudyInputs

MAPS = (
    ("certified_fraction", "{} [%]", 100.0),
    ("exact_fraction", "exact: proved GO [% of the area]", 100.0),
    ("flown_fraction", "flown by the filter [%]", 100.0),
    ("mean_delta_v_m_s", "mean impulse of the safe flights [m/s]", 1.0),
)
_CERTIFIED = {"certified": "certified for ever", "paper": "the paper's conditions, not sound"}
_MOST_WRITTEN = 12


@drawn_as("trade_study.png")
def heat_maps(inputs: TradeStudyInputs, points: Sequence[Mapping[str, Any]]) -> Figure:
    """Four maps over tumble rate (across) and thrust (up); grey without a value."""
    rates, thrusts = inputs.omega_t_deg_s, inputs.a_max_m_s2
    drawing = figure(2.0 * (1.9 + 0.52 * min(len(rates), 14)), 2.0 * (1.2 + 0.36 * min(len(thrusts), 14)))
    written = max(len(rates), len(thrusts)) <= _MOST_WRITTEN
    for panel, (name, title, scale) in zip(drawing.subplots(2, 2).flat, MAPS, strict=True):
        values = np.full((len(thrusts), len(rates)), np.nan)
        for point in points:
            if point[name] is not None:
                where = thrusts.index(point["a_max_m_s2"]), rates.index(point["omega_t_deg_s"])
                values[where] = scale * point[name]
        most = 100.0 if scale == 100.0 else None
        panel.set_facecolor("#DDDDDD")
        image = panel.imshow(values, origin="lower", aspect="auto", cmap="viridis", vmin=0.0, vmax=most)
        panel.set_title(title.format(_CERTIFIED[inputs.certificate]), fontsize=10)
        every = [max(1, len(axis) // 8) for axis in (rates, thrusts)]
        panel.set_xticks(range(0, len(rates), every[0]), [f"{rate:g}" for rate in rates[:: every[0]]])
        panel.set_yticks(range(0, len(thrusts), every[1]), [f"{thrust:g}" for thrust in thrusts[:: every[1]]])
        panel.set_xlabel("tumble rate [deg/s]")
        panel.set_ylabel("a_max [m/s²]")
        if written:
            top = most or (float(np.nanmax(values)) if np.isfinite(values).any() else 1.0)
            for (i, k), value in np.ndenumerate(values):
                if np.isfinite(value):
                    text = f"{value:.0f}" if scale == 100.0 and value >= 9.95 else f"{value:.1f}"
                    colour = "black" if value > 0.6 * top else "white"
                    panel.text(k, i, text, ha="center", va="center", fontsize=8, color=colour)
        drawing.colorbar(image, ax=panel, shrink=0.9)
    return drawing
