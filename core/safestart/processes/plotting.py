"""Shared by all pictures: headless figures, the corridor, PNG and NPZ bytes.

No figure goes through pyplot, so that nothing needs a screen and a notebook keeps its own backend. Pictures have
Matplotlib's own style, whatever style the user has configured.
"""

from __future__ import annotations

import io
import logging
from collections.abc import Callable, Mapping
from functools import wraps
from typing import Any, ParamSpec

import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from safestart.errors import SafestartError
from safestart.model.scenario import CorridorShape
from safestart.processes.base import Artifact
from safestart.processes.output import Undrawn

log = logging.getLogger("safestart.pictures")
Inputs = ParamSpec("Inputs")
NPZ = "application/x-npz"
_LONGEST_REASON = 200


def figure(width: float, height: float) -> Figure:
    """Empty figure in inches, free of global pyplot state (safe in threads)."""
    return Figure(figsize=(width, height), layout="constrained")


def draw_corridor(axes: Axes, shape: CorridorShape, y_max: float) -> Polygon:
    """Outline of the corridor, target at the origin, equal axes, units on the labels; returns the outline."""
    half = shape.x0 + shape.c_x * (y_max - shape.hold_radius)
    x = [-half, -shape.x0, shape.x0, half, -half]
    y = [y_max, shape.hold_radius, shape.hold_radius, y_max, y_max]
    (outline,) = axes.fill(x, y, facecolor="#F2F2F2", edgecolor="#666666", linewidth=1.0, zorder=0)
    axes.plot(0.0, 0.0, marker="s", color="#333333", markersize=5, zorder=5)
    axes.set_aspect("equal")
    axes.set_xlim(-1.03 * half, 1.03 * half)
    axes.set_ylim(-0.05 * y_max, 1.03 * y_max)
    axes.set_xlabel("x body [m]")
    axes.set_ylabel("y body [m]")
    return outline


def drawn_as(name: str) -> Callable[[Callable[Inputs, Figure]], Callable[Inputs, Artifact | Undrawn]]:
    """Decorator: the figure that a function draws, as the PNG artifact ``name``.

    A picture that cannot be drawn is an :class:`Undrawn`: the numbers of the result do not depend on it.
    """

    def decorate(draw: Callable[Inputs, Figure]) -> Callable[Inputs, Artifact | Undrawn]:
        @wraps(draw)
        def drawn(*args: Inputs.args, **options: Inputs.kwargs) -> Artifact | Undrawn:
            try:
                with matplotlib.style.context("default"):
                    return png(name, draw(*args, **options))
            except SafestartError:  # such as the end of a dismissed job
                raise
            except Exception as error:  # a drawing library can raise anything: fonts, memory, disk
                log.warning("%s could not be drawn", name, exc_info=error)
                return Undrawn(name, f"{type(error).__name__}: {error}"[:_LONGEST_REASON])

        return drawn

    return decorate


def png(name: str, drawing: Figure, dpi: int = 130) -> Artifact:
    """Figure as a PNG artifact without a time stamp, so that equal pictures are equal bytes."""
    buffer = io.BytesIO()
    drawing.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return Artifact(name, "image/png", buffer.getvalue())


def npz(name: str, arrays: Mapping[str, NDArray[Any]]) -> Artifact:
    """Arrays as a compressed NPZ artifact (numpy stamps entries with a fixed date, so bytes are reproducible)."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **dict(arrays))
    return Artifact(name, NPZ, buffer.getvalue())
