"""Forward reachable set by support functions in template directions (paper 000, section 7, "FRS").

The recursion h_{k+1}(d) = h_k(A^T d) + a_max |B^T d|_1 (eq. 10) from one start unrolls to
h_N(d) = d . A^N x_0 + const(d), so the constant is computed once for all starts. The 48 supports bound an
OUTER polygon of the box-input set.

A start is in the set iff the outer polygon meets the corridor cone: an outer approximation of
:mod:`~safestart.engines.backward`. The paper asks whether some vertex of the target polygon, the corridor cut at the
grid's ``y_max``, lies in the outer polygon. That is not necessary for reachability (it misses a set that meets the
corridor between its vertices), so it gives no bound; the tests keep it for comparison.
"""

from __future__ import annotations

import time

import numpy as np

from safestart.engines.base import EngineResult, Problem
from safestart.engines.sampled import Step, finish, steps, to_body
from safestart.model.scenario import Floats
from safestart.runtime.progress import Context
from safestart.sets.cone import DualArc, directions
from safestart.sets.cone_meets import warm
from safestart.sets.template import meet_arc

DIRECTIONS = 48


class Forward:
    """Outer approximation of the sampled, box-limited input's set; a tube is the union over the steps 0..N."""

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Margin (m) of every cell, as in :mod:`safestart.sets`; ``arrays`` holds it before the cut to the corridor."""
        compile_s = 0.0 if warm.cache_info().currsize else warm()
        start = time.perf_counter()
        points = problem.points().reshape(-1, 2)
        arc = DualArc.of(problem.scenario.corridor)
        angles = template()
        margin = np.full(len(points), -np.inf)
        for step in steps(problem):
            supports = constants(step, angles, problem.scenario.chaser.max_acceleration)
            positions = points @ to_body(step.drift.T, step.theta)
            np.maximum(margin, meet_arc(angles + step.theta, supports, arc).margin(positions), out=margin)
            context.step(step.index, problem.steps, "steps")
        detail = {
            "set": problem.kind.value,
            "rest": problem.rest.value,
            "input": "box",
            "steps": problem.steps,
            "directions": DIRECTIONS,
            "criterion": "meets",
        }
        return finish(problem, margin, start, compile_s, detail)


def template() -> Floats:
    """Angles (48,) of the template in LVLH, rad from +y towards +x; they hold the four axes."""
    return 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS


def constants(step: Step, angles: Floats, a_max: float) -> Floats:
    """const(d) of eq. (10), shape (48,), metres: a_max times the sum over steps of |([A^j B]_r)^T d|_1."""
    pushed = np.tensordot(step.response, directions(angles), axes=([1], [1]))
    return np.asarray(a_max * np.abs(pushed).sum(axis=(0, 1)))
