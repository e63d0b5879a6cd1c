"""Compiled kernel: the time at which the saturated PD law brings a state into the recovery box."""

from __future__ import annotations

import math

import numpy as np

from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled


@compiled(error_model="numpy")
def _rates(x, y, vx, vy, law):  # type: ignore[no-untyped-def]
    """Accelerations of eq. (5) under eqs. (8), (9), relative to the box's centre; ``law`` as in :func:`arrivals`."""
    w, disk, most_x, most_y = law[0], law[5], law[6], law[7]
    ux = -law[1] * (x - law[8]) - law[3] * (vx - law[10])
    uy = -law[2] * (y - law[9]) - law[4] * (vy - law[11])
    if disk > 0.0:
        size = math.sqrt(ux * ux + uy * uy)
        if size > most_x:
            ux, uy = most_x / size * ux, most_x / size * uy
    else:
        ux, uy = min(max(ux, -most_x), most_x), min(max(uy, -most_y), most_y)
    return ux - 2.0 * w * vy, uy + 2.0 * w * vx + 3.0 * w * w * y


@compiled(error_model="numpy")
def arrivals(states: Floats, law: Floats, half: Floats, step: float, horizon: float, out: Floats) -> None:
    """``out`` (N,): first time (s) at which a state (N, 4) is in the box, checked every ``step``; inf if never.

    ``law`` (12,): mean motion, position gains, speed gains, 1 for a disk and 0 for a box, limits by channel, centre of
    the box; ``half`` (4,) its half widths. Runge-Kutta of order 4.
    """
    steps = math.floor(horizon / step + 1e-9)
    for p in range(len(states)):
        x, y, vx, vy = states[p, 0], states[p, 1], states[p, 2], states[p, 3]
        out[p] = np.inf
        for k in range(steps + 1):
            if (
                abs(x - law[8]) <= half[0]
                and abs(y - law[9]) <= half[1]
                and abs(vx - law[10]) <= half[2]
                and abs(vy - law[11]) <= half[3]
            ):
                out[p] = k * step
                break
            h = 0.5 * step
            ax, ay = _rates(x, y, vx, vy, law)
            bx, by = _rates(x + h * vx, y + h * vy, vx + h * ax, vy + h * ay, law)
            ux, uy = vx + h * ax, vy + h * ay
            wx, wy = vx + h * bx, vy + h * by
            cx, cy = _rates(x + h * ux, y + h * uy, wx, wy, law)
            zx, zy = vx + step * cx, vy + step * cy
            dx, dy = _rates(x + step * wx, y + step * wy, zx, zy, law)
            x += step / 6.0 * (vx + 2.0 * ux + 2.0 * wx + zx)
            y += step / 6.0 * (vy + 2.0 * uy + 2.0 * wy + zy)
            vx += step / 6.0 * (ax + 2.0 * bx + 2.0 * cx + dx)
            vy += step / 6.0 * (ay + 2.0 * by + 2.0 * cy + dy)
