"""Margin of arbitrary starts against the rotating corridor, from the series and the kernel."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from safestart.model.scenario import Floats
from safestart.sets.cone import DualArc
from safestart.sets.reach_kernel import DRIFT, reach_margins, trig_table
from safestart.sets.series import ReachSeries, reach_series

DIRECTIONS = 17
"""Nodes over the dual arc; polished afterwards."""
PHASE_STEP = 0.03
"""Largest turn (rad) of the corridor, or of the orbit, between two coarse times."""
MIN_INTERVALS = 48


@dataclass(frozen=True, slots=True)
class RotatingReach:
    """Reachable sets over [0, series.horizon] seen from a corridor turning at ``tumble_rate`` (rad/s)."""

    series: ReachSeries
    arc: DualArc
    tumble_rate: float
    fastest: float
    bend: Floats
    nodes: Floats
    trig: Floats

    @classmethod
    def of(
        cls,
        motion: Callable[[float], Floats],
        start_velocity: Floats,
        horizon: float,
        a_max: float,
        arc: DualArc,
        tumble_rate: float,
        mean_motion: float,
    ) -> RotatingReach:
        """Build the series (see :func:`~safestart.sets.series.reach_series`) and the node tables."""
        series = reach_series(motion, start_velocity, horizon, a_max)
        nodes = arc.nodes(DIRECTIONS)
        trig = trig_table(nodes, (series.value.shape[1] - DRIFT - 1) // 2)
        # Size of d2m/dt2: thrust, and the centripetal, Coriolis and gravity terms of a drifting start.
        turning = 3.0 * tumble_rate**2 + 12.0 * tumble_rate * mean_motion + 10.0 * mean_motion**2
        bend = np.array([4.0 * a_max, turning])
        return cls(series, arc, tumble_rate, max(tumble_rate, mean_motion), bend, nodes, trig)

    def at(self, points: Floats, moment: float) -> Floats:
        """Margin (P,) in metres of starts (P, 2) at one time (s); NaN when the series did not converge."""
        return self._run(points, np.array([moment]))[0]

    def within(self, points: Floats) -> tuple[Floats, Floats]:
        """Largest margin (P,) over [0, horizon] in metres, and the time (P,) at which it is attained."""
        horizon = self.series.horizon
        intervals = max(MIN_INTERVALS, int(np.ceil(self.fastest * horizon / PHASE_STEP)))
        return self._run(points, np.linspace(0.0, horizon, intervals + 1))

    def _run(self, points: Floats, times: Floats) -> tuple[Floats, Floats]:
        points = np.ascontiguousarray(points, dtype=np.float64)
        margin, when = np.empty(len(points)), np.empty(len(points))
        series, arc = self.series, self.arc
        if not series.converged:
            return np.full(len(points), np.nan), np.full(len(points), np.nan)
        reach_margins(
            points, times, series.horizon, self.tumble_rate, arc.half_width, arc.hold, self.bend,
            series.value, series.slope, self.nodes, self.trig, margin, when,
        )  # fmt: skip
        return margin, when


@cache
def warm() -> float:
    """Compile the kernel (or load it from Numba's cache) once per process; seconds it took the first time."""
    start = time.perf_counter()
    still = np.vstack([np.hstack([np.eye(2), np.eye(2)]), np.hstack([np.zeros((2, 2)), np.eye(2)])])
    arc = DualArc(0.5, 1.0, 0.5)
    tiny = RotatingReach.of(lambda _: still, np.zeros((2, 2)), 1.0, 1.0, arc, 0.0, 0.0)
    tiny.within(np.zeros((1, 2)))
    return time.perf_counter() - start
