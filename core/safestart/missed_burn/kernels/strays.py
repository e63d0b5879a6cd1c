"""How far the true motion about the Earth strays from the linear one, part by part, compiled."""

from __future__ import annotations

import math

import numpy as np

from safestart.dynamics.two_body import J2
from safestart.model.orbit import EARTH_RADIUS as RADIUS
from safestart.model.orbit import MU
from safestart.model.scenario import Floats
from safestart.runtime.kernels.compiled import compiled

UNBOUNDED = 1e30
_UP = 1.0 + 1e-9
_TRIALS = 60


@compiled()
def influence_of(nodes: Floats) -> Floats:
    """Norms (2, 2, P, P) of the blocks of Phi(t_j) Phi(t_m)^-1, m <= j, of symplectic ``nodes`` (P, 6, 6); 0 beyond."""
    count = len(nodes)
    out = np.zeros((2, 2, count, count))
    back = np.empty((6, 6))
    for m in range(count):
        phi = nodes[m]
        for i in range(3):
            for j in range(3):
                back[i, j], back[3 + i, 3 + j] = phi[3 + j, 3 + i], phi[j, i]
                back[i, 3 + j], back[3 + i, j] = -phi[j, 3 + i], -phi[3 + j, i]
        for j in range(m, count):
            for row in range(6):
                for column in range(6):
                    value = 0.0
                    for e in range(6):
                        value += nodes[j, row, e] * back[e, column]
                    out[row // 3, column // 3, j, m] += value * value
    for a in range(2):
        for b in range(2):
            for j in range(count):
                for m in range(j + 1):
                    out[a, b, j, m] = math.sqrt(out[a, b, j, m])
    return out


@compiled()
def remainder(lowest: float, rho: float) -> float:
    """Bound on |w|, m/s^2, up to the distance ``rho`` m; infinite from half the radius on."""
    r = lowest - rho
    if not r > 0.5 * lowest:
        return math.inf
    return (3.0 * MU / r**4 + 30.0 * MU * J2 * RADIUS**2 / r**6) * rho * rho * (1.0 + 1e-12)


@compiled()
def strays_from(
    reached: Floats, influence: Floats, grown: float, slid: float, by_position: float, lowest: float
) -> tuple[Floats, Floats]:
    """Strays and trial radii (P,), m, where the linear motion has ``reached`` (P,) m in each part.

    ``grown``, ``slid``: cosh and sinh/k of a part; a push of 1 m/s^2 over it adds ``by_position`` m and ``slid`` m/s.
    """
    parts = len(reached)
    strays, trials, pushes = np.full(parts, UNBOUNDED), np.full(parts, UNBOUNDED), np.zeros(parts)
    for j in range(parts):
        at, fast = 0.0, 0.0
        for m in range(j):
            # influence[:, :, j, m + 1]: from the end of part m.
            place, speed = by_position * pushes[m], slid * pushes[m]
            at += influence[0, 0, j, m + 1] * place + influence[0, 1, j, m + 1] * speed
            fast += influence[1, 0, j, m + 1] * place + influence[1, 1, j, m + 1] * speed
        before = _UP * (grown * at + slid * fast)
        trial = (reached[j] + before) * _UP + 1e-6
        held = False
        for _ in range(_TRIALS):
            push = remainder(lowest, trial)
            if not math.isfinite(push):
                return strays, trials
            there = before + by_position * push * _UP
            needed = reached[j] + there
            if needed < trial:
                held = True
                break
            trial = needed * _UP + 1e-6
        if not held:
            return strays, trials
        pushes[j], strays[j], trials[j] = push, there, trial
    return strays, trials
