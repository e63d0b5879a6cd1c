"""The hops of an approach (paper 004, Algorithm 1) and their impulses, in CWH motion.

The approach runs along a line through the target that makes ``angle_deg`` with the V-bar: 0 deg ahead of the target,
90 deg below it, 180 deg behind it. It starts and ends at rest in LVLH; every hop ends perpendicular to the line.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from safestart.dynamics.cwh import transition_matrix
from safestart.errors import invalid
from safestart.hopping.hop_time import hop_phases, past_the_fold
from safestart.model.orbit import EARTH_RADIUS as RADIUS
from safestart.model.orbit import MU
from safestart.model.scenario import Floats, number

MOST_HOPS = 100
_ROUND_OFF = 1e-12


@dataclass(frozen=True, slots=True)
class Hop:
    """One hop: the state (6,) LVLH right after its impulse, and right before the next one, ``time`` s later."""

    start: float
    end: float
    phase: float
    time: float
    left_with: Floats
    arrives_with: Floats

    @property
    def rho(self) -> float:
        """The share of the distance that the hop leaves."""
        return self.end / self.start

    @property
    def orbits(self) -> float:
        """Length of the approach, in orbits of the target."""
        return self.phase / math.tau


@dataclass(frozen=True, slots=True)
class Approach:
    """All hops; ``impulses`` (hops + 1, 3), m/s LVLH: one before each hop, the last one stops at the hold point."""

    angle_deg: float
    mean_motion: float
    hops: tuple[Hop, ...]
    impulses: Floats

    @property
    def times(self) -> Floats:
        """Times (hops + 1,) of the impulses, s."""
        return np.concatenate([[0.0], np.cumsum([hop.time for hop in self.hops])])

    @property
    def orbits(self) -> float:
        """Length of the approach in orbits."""
        return math.fsum(hop.phase for hop in self.hops) / math.tau

    @property
    def fuel_1norm(self) -> float:
        """Sum of |impulse|_1 in LVLH axes, m/s."""
        return float(np.abs(self.impulses).sum())

    @property
    def fuel_2norm(self) -> float:
        """Sum of |impulse|_2, m/s."""
        return float(np.linalg.norm(self.impulses, axis=1).sum())

    def states(self) -> Floats:
        """States (hops + 1, 6) right before each impulse: at rest first."""
        first = self.hops[0].left_with.copy()
        first[3:] = 0.0
        return np.array([first, *(hop.arrives_with for hop in self.hops)])


def without_round_off(vectors: Floats) -> Floats:
    """Vectors (K, 3) in which a component below 1e-12 of its vector's size is 0, as on the V-bar, where half an orbit's
    sine is one of round-off."""
    sizes = np.linalg.norm(vectors, axis=1, keepdims=True)
    # A sum with 0 makes -0 a 0.
    out: Floats = np.where(np.abs(vectors) <= _ROUND_OFF * sizes, 0.0, vectors) + 0.0
    return out


def mean_motion_of(semi_major_axis: float) -> float:
    """Mean motion, rad/s, of a circular orbit of this radius, m; raises ``InvalidInput`` inside the Earth."""
    number("semi_major_axis_m", semi_major_axis, RADIUS, 1e9)
    return math.sqrt(MU / semi_major_axis**3)


def line(angle_deg: float) -> Floats:
    """Unit vector (3,), LVLH, from the target along the approach: cos along the V-bar, sin towards nadir."""
    theta = math.radians(angle_deg)
    exact = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
    ahead, below = exact.get(angle_deg % 360.0, (math.cos(theta), math.sin(theta)))
    return np.array([-below, ahead, 0.0])


def distances(start: float, hold: float, hops: int, gamma: float | None = None) -> Floats:
    """Distances (hops + 1,) of the ends of hops; each hop is ``gamma`` times as long as the one before.

    Without gamma the distances shrink geometrically, d_k = start (hold/start)^(k/hops), and so do the hops.
    """
    number("start_m", start, 0.0, 1e5, open_low=True)
    number("hold_m", hold, 0.0, 1e5, open_low=True)
    if not hold < start:
        raise invalid("start_m", f"more than hold_m = {hold:g} m: hops lead towards the target", start)
    if isinstance(hops, bool) or not isinstance(hops, int) or not 1 <= hops <= MOST_HOPS:
        raise invalid("hops", f"an integer in [1, {MOST_HOPS}]", hops)
    k = np.arange(hops + 1)
    if gamma is None:
        spaced: Floats = start * (hold / start) ** (k / hops)
    else:
        number("gamma", gamma, 0.0, 1.0, open_low=True)
        lengths = gamma ** np.arange(hops)
        spaced = start - (start - hold) * np.concatenate([[0.0], np.cumsum(lengths)]) / lengths.sum()
    spaced[0], spaced[-1] = start, hold
    if not (np.diff(spaced) < 0.0).all() or (spaced[1:] / spaced[:-1]).max() > 1.0 - 1e-6:
        raise invalid("gamma", "hops that still differ in length: the last ones come out as nothing", gamma)
    return spaced


def approach(
    mean_motion: float, angle_deg: float, start: float, hold: float, hops: int, gamma: float | None = None
) -> Approach:
    """Algorithm 1: distances, hop times, impulses. Raises ``InvalidInput``, also for an angle past a hop's fold."""
    d = distances(start, hold, hops, gamma)
    rho = d[1:] / d[:-1]
    phases = hop_phases(np.full(len(rho), float(angle_deg)), rho)
    missing = np.isnan(phases)
    if missing.any():
        raise past_the_fold(angle_deg, float(rho[missing][0]))
    return with_phases(mean_motion, angle_deg, d, phases)


def with_phases(mean_motion: float, angle_deg: float, d: Floats, phases: Floats) -> Approach:
    """Hops between the distances ``d`` (hops + 1,), m, that take ``phases`` (hops,), rad, instead of Algorithm 1's.

    They lead from one distance on the line to the next, and no longer end perpendicular to it.
    """
    along = line(angle_deg)
    made, arrived, impulses = [], np.zeros(3), []
    for begin, end, phase in zip(d[:-1].tolist(), d[1:].tolist(), phases.tolist(), strict=True):
        time = phase / mean_motion
        velocity = departure(mean_motion, time, begin * along, end * along)
        left = np.concatenate([begin * along, velocity])
        there = transition_matrix(mean_motion, time) @ left
        made.append(Hop(begin, end, phase, time, left, there))
        impulses.append(velocity - arrived)
        arrived = there[3:]
    impulses.append(-arrived)
    return Approach(float(angle_deg), mean_motion, tuple(made), np.array(impulses))


def departure(mean_motion: float, time: float, begin: Floats, end: Floats) -> Floats:
    """Velocity (3,) with which a chaser leaves ``begin`` (3,) in order to drift to ``end`` (3,) in ``time`` s.

    Only in the plane: at half an orbit no such cross-track velocity exists, and hops need none.
    """
    phi = transition_matrix(mean_motion, time)
    velocity = np.zeros(3)
    velocity[:2] = np.linalg.solve(phi[:2, 3:5], end[:2] - phi[:2, :2] @ begin[:2])
    return velocity
