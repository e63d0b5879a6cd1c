"""Pictures of the encounters: breach probabilities as a table, paths around the keep-out disk, supervised flights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from safestart.collision_avoidance.encounters.adversary import TITLES as ADVERSARIES
from safestart.collision_avoidance.encounters.pilots import TITLES as PILOTS
from safestart.model.scenario import Floats
from safestart.processes.collision_avoidance.flown import Encounters
from safestart.processes.collision_avoidance.spec import CollisionAvoidanceInputs
from safestart.processes.plotting import drawn_as, figure

LOST, SAFE, LINE = "#D55E00", "#0072B2", "#333333"
_TITLES = {"outside": "starts outside the unsafe set, near it", "inside": "starts proved unsafe"}


@drawn_as("encounters.png")
def matrix_picture(rows: Sequence[dict[str, Any]]) -> Figure:
    """Breach probability of every pilot against every adversary, with its interval."""
    kinds = [kind for kind in _TITLES if any(row["starts"] == kind for row in rows)]
    chosen = [[row for row in rows if row["starts"] == kind] for kind in kinds]
    pilots = list(dict.fromkeys(row["pilot"] for row in rows if row["starts"] in kinds))
    widths = [len({row["adversary"] for row in part}) for part in chosen]
    drawing = figure(3.0 + 1.45 * sum(widths), 1.6 + 0.5 * len(pilots))
    panels = drawing.subplots(1, len(kinds), squeeze=False, sharey=True, width_ratios=widths)[0]
    for panel, kind, part in zip(panels, kinds, chosen, strict=True):
        others = list(dict.fromkeys(row["adversary"] for row in part))
        share = np.full((len(pilots), len(others)), np.nan)
        for row in part:
            at = pilots.index(row["pilot"]), others.index(row["adversary"])
            share[at] = row["breach_probability"]
            text = (
                f"{100 * row['breach_probability']:.1f} %\n"
                f"[{100 * row['breach_low']:.1f}, {100 * row['breach_high']:.1f}]"
            )
            dark = row["breach_probability"] > 0.6
            panel.text(
                at[1], at[0], text, ha="center", va="center", fontsize=7.5, color="w" if dark else LINE
            )
        panel.imshow(share, vmin=0.0, vmax=1.0, cmap="Oranges", aspect="auto")
        names = [
            ADVERSARIES[name].split(" (")[0].split(",")[0].replace(" of the miss", "") for name in others
        ]
        panel.set_xticks(range(len(others)), names, fontsize=8.5)
        panel.set_yticks(range(len(pilots)), [PILOTS[name] for name in pilots], fontsize=8.5)
        panel.tick_params(length=0)
        panel.set_title(_TITLES[kind], fontsize=10)
    drawing.suptitle(
        "Loss of separation, % with 95 % interval: pilots (rows) against adversaries", fontsize=11
    )
    return drawing


@drawn_as("flights.png")
def flights_picture(inputs: CollisionAvoidanceInputs, flown: Encounters) -> Figure:
    """The closest flights of some pilots from the same set of starts, and separation over time under supervision."""
    around = [name for name in flown.paths if name != "supervisor"]
    supervised = "supervisor" in flown.paths
    count = max(1, len(around) + supervised)
    drawing = figure(4.1 * count + 0.4, 5.0)
    panels = drawing.subplots(1, count, squeeze=False)[0]
    reach = max((float(np.abs(flown.paths[name][..., :2]).max()) for name in around), default=1.0)
    for panel, name in zip(panels, around, strict=False):
        _around(panel, flown.paths[name], inputs.keep_out_m, 1.05 * reach)
        panel.set_title(
            f"{PILOTS[name]}:\nits closest flights, {inputs.adversaries[0]} adversary", fontsize=9.5
        )
    if supervised:
        _over_time(panels[-1], flown.paths["supervisor"], inputs)
    drawing.suptitle("Dots: starts; orange: came within the keep-out distance", fontsize=11)
    return drawing


def _around(panel: Axes, paths: Floats, keep_out: float, reach: float) -> None:
    panel.add_patch(Circle((0, 0), keep_out, facecolor="#F2F2F2", edgecolor=LINE, linestyle="--"))
    for k in range(paths.shape[1]):
        path = paths[:, k, :2]
        colour = LOST if np.linalg.norm(path, axis=1).min() <= keep_out else SAFE
        panel.plot(path[:, 0], path[:, 1], color=colour, linewidth=1.0, alpha=0.8)
        panel.plot(*path[0], marker="o", markersize=3.5, color=colour)
    panel.set_xlim(-reach, reach)
    panel.set_ylim(-reach, reach)
    panel.set_aspect("equal")
    panel.set_xlabel("x tangential [m]")
    panel.set_ylabel("y radial [m]")


def _over_time(panel: Axes, paths: Floats, inputs: CollisionAvoidanceInputs) -> None:
    minutes = inputs.period_s * np.arange(len(paths)) / 60.0
    panel.plot(minutes, np.linalg.norm(paths[..., :2], axis=2), color=SAFE, linewidth=0.7, alpha=0.6)
    panel.axhline(inputs.keep_out_m, color=LINE, linestyle="--", linewidth=1.0)
    panel.axvspan(0.0, inputs.threat_s / 60.0, color=LOST, alpha=0.12, linewidth=0)
    panel.text(0.5 * inputs.threat_s / 60.0, 0.98, "Player 2\nacts", ha="center", va="top", fontsize=8,
               transform=panel.get_xaxis_transform())  # fmt: skip
    panel.set_ylim(bottom=0.0)
    panel.set_xlabel("time [min]")
    panel.set_ylabel("separation [m]")
    panel.set_title(f"supervised flights, back to the slot\n(dashed: {inputs.keep_out_m:g} m)", fontsize=9.5)
