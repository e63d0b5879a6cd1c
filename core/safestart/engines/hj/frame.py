"""The two frames for a grid of the motion towards the tumbling corridor.

Seen from the rotating body frame, with J the +90 degree rotation and w = omega_t, CWH (paper 000, eq. 1) is

    dv/dt = -2 (w + n) J v + (w^2 + 2 n w + 1.5 n^2) p + 1.5 n^2 Q(2 w t) p + u,
    Q(a) = [[cos a, -sin a], [-sin a, -cos a]].

The corridor is fixed there, but the last term turns at 2 w and would make the problem time-varying. We drop it; its
size is 1.5 n^2 |p|, 5e-4 m/s^2 at 272 m on a low orbit. Speeds are of the order of w r.

In LVLH axes CWH is time-invariant, and the corridor turns. Starts at rest there have zero speed, so a velocity axis
need cover only speeds that thrust can reach, at any tumble rate.
"""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

import numpy as np

from safestart.model.scenario import Floats, Target


class Frame(StrEnum):
    """Axes of the state (x, y, vx, vy); they coincide at t = 0, but velocities differ by omega x p."""

    BODY = "body"
    LVLH = "lvlh"


MODEL = {
    Frame.BODY: "rotating body frame, time-invariant; dropped: gravity-gradient part 1.5 n^2 Q(2 omega_t t) p, "
    "which turns at twice the tumble rate",
    Frame.LVLH: "LVLH, CWH as it is, the corridor turns; nothing dropped",
}
"""The parts of CWH that a frame's equations drop."""


class Coefficients(NamedTuple):
    """x'' = gx x + turn y' + ux, y'' = gy y - turn x' + uy; ``turn`` in 1/s, ``gx`` and ``gy`` in 1/s^2."""

    turn: float
    gx: float
    gy: float


def coefficients(target: Target, frame: Frame) -> Coefficients:
    """Body: turn 2 (w + n), gx = gy = w^2 + 2 n w + 1.5 n^2. LVLH: turn 2 n, gx = 3 n^2, gy = 0."""
    w, n = target.tumble_rate, target.mean_motion
    if frame is Frame.BODY:
        push = w * w + 2.0 * n * w + 1.5 * n * n
        return Coefficients(2.0 * (w + n), push, push)
    return Coefficients(2.0 * n, 3.0 * n * n, 0.0)


def system_matrix(target: Target, frame: Frame) -> Floats:
    """A (4, 4) of the state (x, y, vx, vy); the input matrix is [0; I]."""
    turn, gx, gy = coefficients(target, frame)
    a = np.zeros((4, 4))
    a[0, 2] = a[1, 3] = 1.0
    a[2, 0], a[3, 1] = gx, gy
    a[2, 3], a[3, 2] = turn, -turn
    return a
