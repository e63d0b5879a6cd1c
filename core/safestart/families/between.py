"""Bounds between the checked values of a parameter, so that checking the corners is enough.

*Tumble rate.* With the in-plane part of a face's normal a and of the position r, the distance at time t is
b - |a||r| cos(w t - psi): a constant plus a sinusoid g of the angle, so between two angles lo and hi, 2 delta apart,

    g(x) = (g(lo) sin(hi - x) + g(hi) sin(x - lo)) / sin(2 delta) >= min(gamma, gamma / cos(delta)),

gamma = min(g(lo), g(hi)). Where gamma >= 0 the worst rate is an end of the interval.

*Mean motion.* f is smooth in n; y = dr/dn and z = d2r/dn2 solve the CWH equations driven by r and v, and Gronwall's
inequality bounds them: between two values f is above the chord less (change of n)^2 / 8 max |z|, below it plus as much.

*Thrust.* The larger disk holds the smaller: GO at the lower end, NO_GO at the upper end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from safestart.model.scenario import Bools, Floats

_LARGEST_EXPONENT = 300.0


@dataclass(frozen=True, slots=True)
class Reach:
    """Bounds on every flight of a family up to T: |r(t)| (m), |v| (m/s), |d2r/dn2| (m per (rad/s)^2)."""

    distance: float
    speed: float
    push: float
    growth: float
    bend: float

    def within(self, time: Floats) -> Floats:
        """Bound on |r| at times up to T."""
        out: Floats = self.distance + self.growth * (time * self.speed + 0.5 * time**2 * self.push)
        return out


def reach(distance: float, speed: float, thrust: float, motion: float, horizon: float) -> Reach:
    """Bounds from |r(0)|, |v(0)|, the thrust limit, the largest mean motion n, and T (docs/theory/uncertainty.md)."""
    n, t = motion, horizon
    # No 2 n t in the exponent: the Coriolis term is perpendicular to the velocity and does no work.
    growth = math.exp(min(1.5 * (n * t) ** 2, _LARGEST_EXPONENT))
    push = 3.0 * n * n * distance + thrust
    v = growth * (speed + t * push)
    r = distance + growth * (t * speed + 0.5 * t * t * push)
    drive = 6.0 * n * r + 2.0 * v
    y, y_rate = 0.5 * t * t * drive * growth, t * drive * growth
    bend = 0.5 * t * t * growth * (12.0 * n * y + 4.0 * y_rate + 6.0 * r)
    return Reach(distance, speed, push, growth, bend)


def half_angle(rates: tuple[float, ...], horizon: float) -> float:
    """Largest half difference of the turn at T between neighbouring rates, rad."""
    return 0.5 * horizon * max((b - a for a, b in pairwise(rates)), default=0.0)


def chord_gap(values: tuple[float, ...], curvature: float) -> float:
    """How far a function with this largest second derivative deviates from the chord between neighbouring values."""
    return max((b - a for a, b in pairwise(values)), default=0.0) ** 2 / 8.0 * curvature


def turned(lowest: Floats, offsets: Floats, aside: Bools, delta: float) -> Floats:
    """Bounds on the distances (F,) at all rates from those at the nodes, ``lowest`` (F,), where all are positive.

    ``offsets`` (F,) are the distances of the target's centre, ``aside`` (F,) marks the faces that lean in x. The others
    depend only on how far the chaser is ahead of the target, which the hold plane makes positive, so the worst rate is
    a node.
    """
    below = np.minimum(lowest - offsets, 0.0)
    out: Floats = lowest + np.where(aside, below * (1.0 / math.cos(delta) - 1.0), 0.0)
    return out


def nodes(low: float, high: float, parts: int) -> tuple[float, ...]:
    """``parts`` + 1 equally spaced values with the ends exact; one value where they coincide."""
    if low == high:
        return (low,)
    step = (high - low) / parts
    return (low, *(low + k * step for k in range(1, parts)), high)
