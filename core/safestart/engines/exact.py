"""Exact set of starts that can reach the rotating corridor, without a grid in state space.

The thrust is a disk, the dynamics are linear (CWH in LVLH, seen from the turning corridor: nothing is frozen
or dropped) and the corridor is convex at every instant. So the start p belongs to the set at time t exactly
when no direction of the corridor's dual cone separates the corridor from p's reachable positions,

    m(t, p) = min over |a| <= atan(1/c_x) of  d(a) . q(t, p) + S(t, a) + x0 |sin a| - r_h cos a  >= 0,

d(a) = (sin a, cos a), q the drift of p in body axes and S the support function of the reachable displacement
(see :mod:`safestart.sets`). The tube (paper 000, section 7, "HJ") is max over t of m. Both extrema are
polished with closed-form derivatives: margins are good to 1e-4 m, and to 1e-7 m where they decide the mask.
"""

from __future__ import annotations

import math
import time
from functools import partial

import numpy as np

from safestart.dynamics.cwh import planar_transition
from safestart.engines.base import MAX_HORIZON, EngineResult, Problem, ResultCode
from safestart.engines.region import ROUND_OFF, restrict, start_velocity
from safestart.errors import invalid
from safestart.model.scenario import Floats, Rest, Scenario, SetKind, number
from safestart.runtime.progress import Context
from safestart.sets.cone import DualArc
from safestart.sets.rotating_reach import RotatingReach, warm

CHUNK = 8192
"""Cells between two polls of the context."""


class Exact:
    """Exact reachable set of the disk input, tube or fixed time; the reference for the gridded engines."""

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Margin of every cell.

        ``arrays`` holds ``margin_unrestricted`` (ny, nx), the margin of the set before its restriction to the corridor
        (a restricted tube is the whole corridor), and ``reach_time`` (ny, nx), the time (s) at which that margin is
        attained.
        """
        compile_s = 0.0 if warm.cache_info().currsize else warm()
        start = time.perf_counter()
        points = problem.points().reshape(-1, 2)
        reach = reach_of(problem.scenario, problem.horizon, problem.rest)
        margin, when = np.empty(len(points)), np.empty(len(points))
        for first in range(0, len(points), CHUNK):
            part = slice(first, first + CHUNK)
            if problem.kind is SetKind.TUBE:
                margin[part], when[part] = reach.within(points[part])
            else:
                margin[part], when[part] = reach.at(points[part], problem.horizon), problem.horizon
            context.step(min(first + CHUNK, len(points)), len(points), "cells")
        shape = (problem.grid.ny, problem.grid.nx)
        detail = {"set": problem.kind.value, "rest": problem.rest.value, "input": "disk"}
        if not np.isfinite(margin).all():
            run = time.perf_counter() - start
            message = "the margin is not finite: horizon and mean motion are outside what the series can hold"
            code = ResultCode.NUMERICAL_FAILURE
            return EngineResult(code, None, None, run, compile_s, message, detail)
        field = margin.reshape(shape)
        mask, restricted = restrict(problem, field)
        run = time.perf_counter() - start
        arrays = {"margin_unrestricted": field, "reach_time": when.reshape(shape)}
        code = ResultCode.OK
        return EngineResult(code, mask, restricted, run, compile_s, detail=detail, arrays=arrays)


def containment_horizon(
    scenario: Scenario,
    points: Floats,
    rest: Rest = Rest.LVLH,
    dt: float = 2.0,
    bound: float = 600.0,
    start: float = 0.0,
) -> float | None:
    """Smallest multiple of ``dt`` (s) from ``start`` up to ``bound`` at which the fixed-time set holds all starts.

    None when there is none. Starts inside the corridor are trivially contained for very short horizons, so
    ``start`` is usually the horizon at which containment was found violated. Because the corridor turns, a longer
    horizon can lose starts again, so the answer is the first such horizon and not a threshold.
    """
    bound = number("bound", bound, 0.0, MAX_HORIZON, open_low=True)
    dt = number("dt", dt, 0.0, bound, open_low=True)
    start = number("start", start, 0.0, bound)
    flat = _planar(points).reshape(-1, 2)
    reach = reach_of(scenario, bound, rest)
    first = max(1, math.ceil(start / dt * (1.0 - 1e-12)))
    for k in range(first, int(bound / dt * (1.0 + 1e-12)) + 1):
        # Try the start that failed last first: it usually fails again and saves the other starts.
        moment = min(k * dt, bound)
        if len(flat) and not reach.at(flat[:1], moment)[0] >= -ROUND_OFF:
            continue
        margin = reach.at(flat, moment)
        worst = int(np.argmin(margin)) if len(flat) else -1
        if worst < 0 or margin[worst] >= -ROUND_OFF:
            return moment
        flat = np.concatenate([flat[worst : worst + 1], np.delete(flat, worst, axis=0)])
    return None


def _planar(points: Floats) -> Floats:
    points = np.asarray(points, dtype=np.float64)
    if points.ndim == 0 or points.shape[-1] != 2:
        raise invalid("points", "last axis of length 2 (metres)", points.shape)
    if not np.isfinite(points).all():
        raise invalid("points", "finite coordinates in metres", "NaN or infinity")
    return points


def reach_of(scenario: Scenario, horizon: float, rest: Rest) -> RotatingReach:
    """The reachable positions of starts at ``rest`` up to ``horizon`` s, seen from the turning corridor."""
    target = scenario.target
    return RotatingReach.of(
        partial(planar_transition, target.mean_motion),
        start_velocity(scenario, rest),
        horizon,
        scenario.chaser.max_acceleration,
        DualArc.of(scenario.corridor),
        target.tumble_rate,
        target.mean_motion,
    )
