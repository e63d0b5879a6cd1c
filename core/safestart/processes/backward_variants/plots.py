"""Picture of backward-variants, like Figs. 1 and 2 of paper 000: nominal, stochastic, robust, side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from safestart.model.scenario import Floats
from safestart.processes.backward_variants.spec import BackwardVariantsInputs, PlanarCwhInput
from safestart.processes.plotting import drawn_as, figure
from safestart.sets.backward.variants import Variant

_COLOURS = ("#0072B2", "#666666")
_PANELS = (
    ("nominal", (("nominal", "-", "nominal"),)),
    (
        "stochastic",
        (
            ("nominal", ":", "nominal"),
            ("chance_open_loop_outer", "-.", "open loop, outer"),
            ("chance_open_loop", "-", "open loop, inner"),
            ("chance_feedback", "--", "feedback, inner"),
        ),
    ),
    (
        "robust",
        (
            ("nominal", ":", "nominal"),
            ("robust_feedback_outer", "-.", "feedback, outer"),
            ("robust_feedback", "--", "feedback"),
            ("robust_open_loop", "-", "open loop"),
        ),
    ),
)
_MOST_POINTS = 1500

Shown = Sequence[tuple[str, Mapping[str, Variant], Floats | None]]


@drawn_as("backward_variants.png")
def picture(inputs: BackwardVariantsInputs, shown: Shown) -> Figure:
    """Three panels with equal axes; colours are systems, line styles are sets, dots the empirical set."""
    drawing = figure(13.5, 6.0)
    panels = drawing.subplots(1, 3, sharex=True, sharey=True)
    for axes, (title, lines) in zip(panels, _PANELS, strict=True):
        for (name, found, cloud), colour in zip(shown, _COLOURS, strict=False):
            label = f"{name.replace('_', ' ')}: " if len(shown) > 1 else ""
            if title == "stochastic" and cloud is not None:
                kept = cloud[:_MOST_POINTS]
                axes.plot(*kept.T, ".", color=colour, markersize=1.5, alpha=0.35, zorder=1)
            for variant, style, text in lines:
                _draw(axes, found.get(variant), style, colour, label + text)
        axes.plot(
            *[inputs.target[k] for k in inputs.plane], marker="+", color="#D55E00", markersize=10, zorder=6
        )
        axes.set_title(title + (" (dots: empirical)" if title == "stochastic" else ""), fontsize=10)
        axes.set_xlabel(_label(inputs, 0))
        axes.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2)
    panels[0].set_ylabel(_label(inputs, 1))
    if isinstance(inputs.system, PlanarCwhInput) and inputs.plane == (0, 1):
        panels[0].set_aspect("equal")
    drawing.suptitle(
        f"Backward reachable sets, N = {inputs.steps}, risk {inputs.risk:g}"
        + (", section" if any(value is not None for value in inputs.section or []) else ""),
        fontsize=11,
    )
    return drawing


def _label(inputs: BackwardVariantsInputs, which: int) -> str:
    component = inputs.plane[which]
    if isinstance(inputs.system, PlanarCwhInput):
        return ("x radial [m]", "y along-track [m]", "vx [m/s]", "vy [m/s]")[component]
    return f"x{component + 1}"


def _draw(axes: Axes, variant: Variant | None, style: str, colour: str, label: str) -> None:
    if variant is None:
        return
    if variant.outline is None:
        axes.plot([], [], style, color=colour, label=f"{label} ({variant.code.replace('_', ' ')})")
        return
    ring = np.concatenate([variant.outline, variant.outline[:1]])
    axes.plot(*ring.T, style, color=colour, linewidth=1.4, label=label, zorder=3)
