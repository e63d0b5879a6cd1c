"""One flight in progress, watched at all times: any motion, any attitude, any constraints.

Between two samples h seconds apart a distance is enclosed by the cubic through value and slope at both: the true one is
at most h^4 / 384 times the largest fourth derivative away. The cubic's minimum is closed-form; where it is negative,
its root is the time of the violation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from safestart.attitude.attitude import Attitude
from safestart.constraints.constraint import Constraint
from safestart.constraints.cubic import dips
from safestart.model.scenario import Floats
from safestart.simulation.passage import cubic_root
from safestart.simulation.plant import Plant

LONGEST_SAMPLE_S, LARGEST_TURN = 0.5, 0.02


def samples_of(attitude: Attitude, dt: float) -> int:
    """Parts of an interval of ``dt`` seconds between which a cubic follows a face distance to about 1e-7 m."""
    rate = attitude.rate_bounds()[0]
    longest = min(LONGEST_SAMPLE_S, LARGEST_TURN / rate if rate > 0.0 else math.inf)
    return math.ceil(dt / longest)


class Watched(Protocol):
    """The interface of a flight to the loop."""

    state: Floats
    """LVLH state (6,) now, m and m/s."""
    time: float
    """Seconds flown: whole intervals, or less if the last one ended at a violation."""
    margin: float
    """Least distance of any constraint so far, m; NaN if the state became non-finite."""
    violated_at: float
    """Seconds until the first violation, infinite without one."""

    def fly(self, thrust: Floats, impulse: Floats | None = None) -> None:
        """One interval, or to a violation: ``impulse`` (3,), m/s, at its start; ``thrust`` (3,), m/s^2, in LVLH."""
        ...


class WatchedFlight:
    """The general flight, in NumPy. It flies an interval to its end, even if the first violation is in it."""

    def __init__(self, plant: Plant, constraints: Sequence[Constraint], start: Floats, dt: float) -> None:
        self._attitude, self._constraints, self._dt = plant.attitude, tuple(constraints), dt
        self._samples = samples_of(plant.attitude, dt)
        self._underway = plant.motion.start(start)
        self._intervals = 0
        self.state, self.time = np.array(start, dtype=np.float64), 0.0
        value, _ = self._room(np.zeros(1), self.state[None])
        self.margin = float(value.min(initial=math.inf))
        self.violated_at = math.inf if self.margin >= 0.0 else 0.0

    def fly(self, thrust: Floats, impulse: Floats | None = None) -> None:
        """One interval."""
        begin = self._intervals * self._dt
        step = self._dt / self._samples
        times: Floats = begin + step * np.arange(self._samples + 1.0)
        if impulse is not None:
            self._underway.push(impulse)
        states = self._underway.fly(thrust, times)
        value, slope = self._room(times, states)
        slope *= step
        low, at = dips(value, slope)
        self._intervals += 1
        self.state, self.time = states[-1], float(times[-1])
        out = np.nonzero((low < 0.0).any(axis=1))[0]
        seen = low if not len(out) else low[: out[0] + 1]
        finite = np.isfinite(low).all() and np.isfinite(self.state).all()
        self.margin = min(self.margin, float(seen.min(initial=math.inf))) if finite else math.nan
        if len(out):
            k = int(out[0])
            roots = [
                cubic_root(value[k, i], slope[k, i], value[k + 1, i], slope[k + 1, i], at[k, i])
                for i in np.nonzero(low[k] < 0.0)[0]
            ]
            self.violated_at = float(times[k]) + step * min(roots)

    def _room(self, times: Floats, states: Floats) -> tuple[Floats, Floats]:
        found = [constraint.room(times, states, self._attitude) for constraint in self._constraints]
        if not found:
            return np.empty((len(times), 0)), np.empty((len(times), 0))
        return np.concatenate([v for v, _ in found], axis=1), np.concatenate([r for _, r in found], axis=1)
