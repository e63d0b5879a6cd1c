"""Backward reachable set under the box input (paper 000, section 7, "BRS"), nominal or robust.

A start belongs to the set iff some |u_i| <= a_max per LVLH axis, held over N intervals, brings the chaser at
rest there into the corridor at step N. The reachable positions form a planar zonotope, so the linear program
of the paper has a closed answer: no generator normal (nor end of the corridor's dual arc, nor the axis)
separates the zonotope from the corridor. The target is the corridor cone itself, not cut at the grid's edge,
as for the other engines.

Robust: one input history must do for every disturbance |w_i| <= w_max per LVLH axis, held over the intervals. What the
disturbances add at step N is a zonotope W, and p + W lies in the corridor iff p keeps a distance of the support of W to
each face: the test is the same with the corridor narrowed. Its left and right faces move apart by different lengths,
so it is also shifted across.
"""

from __future__ import annotations

import time

import numpy as np

from safestart.engines.backward_options import BackwardInput
from safestart.engines.base import EngineResult, Problem
from safestart.engines.sampled import finish, steps, to_body
from safestart.model.scenario import CorridorShape, Floats
from safestart.runtime.progress import Context
from safestart.sets.cone import DualArc
from safestart.sets.cone_meets import warm
from safestart.sets.zonotope import meet_arc, support


class Backward:
    """Exact set of the sampled, box-limited input; a tube is the union over the steps 0..N."""

    def __init__(self, options: BackwardInput | None = None) -> None:
        self._disturbance = (options or BackwardInput.model_validate({})).disturbance_m_s2

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Margin (m) of every cell; ``arrays`` holds it before the cut to the corridor."""
        compile_s = 0.0 if warm.cache_info().currsize else warm()
        start = time.perf_counter()
        points = problem.points().reshape(-1, 2)
        arc, shift = DualArc.of(problem.scenario.corridor), np.zeros(2)
        a_max, total = problem.scenario.chaser.max_acceleration, problem.steps
        margin = np.full(len(points), -np.inf)
        for step in steps(problem):
            # Column i of [A^j B]_r, scaled by a_max, is one generator.
            generators = to_body(a_max * step.response.transpose(0, 2, 1).reshape(-1, 2), step.theta)
            positions = points @ to_body(step.drift.T, step.theta)
            if self._disturbance > 0.0:
                arc, shift = narrowed(problem.scenario.corridor, generators * (self._disturbance / a_max))
            np.maximum(margin, meet_arc(generators, arc).margin(positions - shift), out=margin)
            context.step(step.index, total, "steps")
        detail: dict[str, object] = {
            "set": problem.kind.value,
            "rest": problem.rest.value,
            "input": "box",
            "steps": total,
        }
        if self._disturbance > 0.0:
            detail["disturbance_m_s2"] = self._disturbance
        return finish(problem, margin, start, compile_s, detail)


def narrowed(shape: CorridorShape, disturbance: Floats) -> tuple[DualArc, Floats]:
    """The corridor of points p with p + W inside, W the zonotope of ``disturbance`` (G, 2), body axes; and its shift.

    The points are ``shift`` (2,) plus those of a corridor of the same slope.
    """
    slope = shape.c_x
    hold, right, left = support(disturbance, np.array([[0.0, -1.0], [1.0, -slope], [-1.0, -slope]]))
    bound = shape.x0 - slope * shape.hold_radius - 0.5 * float(right + left)
    height = shape.hold_radius + float(hold)
    width = bound + slope * height
    if width < 0.0:
        # The sides meet above the hold plane.
        height, width = -bound / slope, 0.0
    arc = DualArc(DualArc.of(shape).half_angle, width, height)
    return arc, np.array([0.5 * float(left - right), 0.0])
