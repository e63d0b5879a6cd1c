"""Limits on norms in space, as in :mod:`safestart.exact.limits`: with C(t) the attitude and w its rate in body axes,

    hold: M = [C, 0];   rest: M = s [-(w x) C, C];   speed: M = S [0, I].

At an entry of a table, where w jumps, the end counts with the turn before it.
"""

from __future__ import annotations

import numpy as np

from safestart.attitude.turning import SmoothAttitude
from safestart.exact.limits import SPEED, Limit, speed_limit
from safestart.exact.question import Goal
from safestart.model.scenario import Floats


def limit_at(
    attitude: SmoothAttitude, goal: Goal | None, most: float | None, name: str, time: float
) -> Limit:
    """The limit ``hold``, ``rest`` or ``speed`` at a time in seconds; ``most`` is the speed limit, m/s."""
    if name == SPEED or goal is None:
        return speed_limit(float(most or 0.0), 3)
    at = np.array([time])
    turn = attitude.rotation(at)[0]
    matrix = np.zeros((3, 6))
    if name == "hold":
        matrix[:, :3] = turn
        return Limit(matrix, np.array(goal.hold, dtype=np.float64), goal.radius)
    omega = attitude.angular_velocity(np.nextafter(at, -np.inf))[0]
    matrix[:, :3] = -goal.scale * np.cross(omega, turn, axisb=0, axisc=0)
    matrix[:, 3:] = goal.scale * turn
    return Limit(matrix, np.zeros(3), goal.radius)


def speed_room(
    limit: float,
    pulls: tuple[Floats, Floats, Floats],
    flown: Floats,
    push: Floats,
) -> tuple[Floats, Floats]:
    """v_max^2 - |v|^2 and its rate, both (P,), of states ``flown`` (P, 6) under accelerations ``push`` (P, 3).

    ``pulls`` are nu', nu'' and mu / r^3 (P,). The Coriolis term does no work: it is left out.
    """
    w, change, tide = pulls
    r, v = flown[:, :3], flown[:, 3:]
    pull = push.copy()
    pull[:, 0] += (w * w + 2.0 * tide) * r[:, 0] + change * r[:, 1]
    pull[:, 1] += (w * w - tide) * r[:, 1] - change * r[:, 0]
    pull[:, 2] -= tide * r[:, 2]
    left: Floats = limit * limit - np.square(v).sum(axis=1)
    return left, -2.0 * (v * pull).sum(axis=1)
