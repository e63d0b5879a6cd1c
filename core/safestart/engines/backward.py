"""Nominal backward reachable set under the box input (paper 000, section 7, "BRS").

A start belongs to the set iff some |u_i| <= a_max per LVLH axis, held over N intervals, brings the chaser at
rest there into the corridor at step N. The reachable positions form a planar zonotope, so the linear program
of the paper has a closed answer: no generator normal (nor end of the corridor's dual arc, nor the axis)
separates the zonotope from the corridor. The target is the corridor cone itself, not cut at the grid's edge,
as for the other engines.
"""

from __future__ import annotations

import time

import numpy as np

from safestart.engines.base import EngineResult, Problem
from safestart.engines.sampled import finish, steps, to_body
from safestart.runtime.progress import Context
from safestart.sets.cone import DualArc
from safestart.sets.cone_meets import warm
from safestart.sets.zonotope import meet_arc


class Backward:
    """Exact set of the sampled, box-limited input; a tube is the union over the steps 0..N."""

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Margin (m) of every cell; ``arrays`` holds it before the cut to the corridor."""
        compile_s = 0.0 if warm.cache_info().currsize else warm()
        start = time.perf_counter()
        points = problem.points().reshape(-1, 2)
        arc = DualArc.of(problem.scenario.corridor)
        a_max, total = problem.scenario.chaser.max_acceleration, problem.steps
        margin = np.full(len(points), -np.inf)
        for step in steps(problem):
            # Column i of [A^j B]_r, scaled by a_max, is one generator.
            generators = to_body(a_max * step.response.transpose(0, 2, 1).reshape(-1, 2), step.theta)
            positions = points @ to_body(step.drift.T, step.theta)
            np.maximum(margin, meet_arc(generators, arc).margin(positions), out=margin)
            context.step(step.index, total, "steps")
        detail = {"set": problem.kind.value, "rest": problem.rest.value, "input": "box", "steps": total}
        return finish(problem, margin, start, compile_s, detail)
