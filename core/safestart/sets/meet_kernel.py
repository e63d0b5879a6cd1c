"""Compiled kernel: margin between a convex polygon, moved to many places, and the corridor cone."""

from __future__ import annotations

import math

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled


@compiled(error_model="numpy")
def meet_margins(positions: Floats, unit: Floats, vertices: Floats, margin: Floats) -> None:
    """Write the margin (P,) in metres of the polygon moved by each of ``positions`` (P, 2).

    ``unit`` (m + 1, 2) are the directions of the breakpoints, angles ascending from +y towards +x over less
    than half a turn; between breakpoints j and j + 1 the support function is d . ``vertices[j]`` (m, 2).

    Per piece the function of the angle is a sinusoid |v| cos(.), v = position + vertex: its minimum is at a
    breakpoint, or -|v| where -v points into the piece (the nearest point is then a corner). A negative margin
    is unimodal in the angle (separating directions form a convex cone), so only the two pieces beside the best
    breakpoint can hold such a corner.
    """
    pieces = vertices.shape[0]
    for i in range(positions.shape[0]):
        px, py = positions[i, 0], positions[i, 1]
        # The function is continuous: either neighbouring piece gives its value at a breakpoint.
        x, y = px + vertices[pieces - 1, 0], py + vertices[pieces - 1, 1]
        least, best = unit[pieces, 0] * x + unit[pieces, 1] * y, pieces
        for j in range(pieces):
            value = unit[j, 0] * (px + vertices[j, 0]) + unit[j, 1] * (py + vertices[j, 1])
            if value < least:
                least, best = value, j
        if least < 0.0:
            for j in range(max(best - 1, 0), min(best + 1, pieces)):
                x, y = px + vertices[j, 0], py + vertices[j, 1]
                after = unit[j, 0] * y >= unit[j, 1] * x
                before = unit[j + 1, 0] * y <= unit[j + 1, 1] * x
                middle_x, middle_y = unit[j, 0] + unit[j + 1, 0], unit[j, 1] + unit[j + 1, 1]
                away = middle_x * x + middle_y * y < 0.0
                if after and before and away:
                    least = min(least, -math.sqrt(x * x + y * y))
        margin[i] = least
