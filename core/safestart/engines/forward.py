"""Forward reachable set by support functions in template directions (paper 000, section 7, "FRS").

The recursion h_{k+1}(d) = h_k(A^T d) + a_max |B^T d|_1 (eq. 10) from one start unrolls to
h_N(d) = d . A^N x_0 + const(d), so the constant is computed once for all starts. The 48 supports bound an
OUTER polygon of the box-input set.

Criterion ``meets`` (default): the outer polygon meets the corridor cone. It is an outer approximation of
:mod:`~safestart.engines.backward`. Criterion ``vertex`` is the paper's: some vertex of the target polygon, the
corridor cut at the grid's ``y_max``, lies in the outer polygon. That is not a necessary condition for
reachability (a set that meets the corridor between its vertices is missed), so it bounds nothing; it is kept
for comparison with the published table.
"""

from __future__ import annotations

import time

import numpy as np

from safestart.engines.base import EngineResult, Problem
from safestart.engines.sampled import Step, finish, steps, to_body
from safestart.errors import invalid
from safestart.model.scenario import CorridorShape, Floats
from safestart.runtime.progress import Context
from safestart.sets.cone import DualArc, directions
from safestart.sets.cone_meets import warm
from safestart.sets.template import meet_arc

DIRECTIONS = 48
CRITERIA = ("meets", "vertex")


class Forward:
    """Outer approximation of the sampled, box-limited input's set; a tube is the union over the steps 0..N."""

    name = "forward"
    summary = "forward reachable set: 48 template supports, outer approximation of the box input's set"

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Margin (m) of every cell; ``arrays`` holds it before the cut to the corridor.

        Margin of ``meets``: as in :mod:`safestart.sets`. Margin of ``vertex``: the largest, over the target's
        vertices, of the least slack among the polygon's faces.
        """
        problem.check_options(self.name, ("criterion",))
        criterion = problem.option(self.name, "criterion", CRITERIA[0])
        if criterion not in CRITERIA:
            raise invalid(f"options.{self.name}.criterion", f"one of {', '.join(CRITERIA)}", criterion)
        compile_s = 0.0 if warm.cache_info().currsize else warm()
        start = time.perf_counter()
        points = problem.points().reshape(-1, 2)
        arc = DualArc.of(problem.scenario.corridor)
        target = target_vertices(problem.scenario.corridor, problem.grid.y_max)
        angles = template()
        margin = np.full(len(points), -np.inf)
        for step in steps(problem):
            supports = constants(step, angles, problem.scenario.chaser.max_acceleration)
            positions = points @ to_body(step.drift.T, step.theta)
            if criterion == "meets":
                now = meet_arc(angles + step.theta, supports, arc).margin(positions)
            else:
                now = _vertex_margin(directions(angles + step.theta), supports, positions, target)
            np.maximum(margin, now, out=margin)
            context.step(step.index, problem.steps, "steps")
        detail = {
            "set": problem.kind.value,
            "rest": problem.rest.value,
            "input": "box",
            "steps": problem.steps,
            "directions": DIRECTIONS,
            "criterion": criterion,
        }
        return finish(self.name, problem, margin, start, compile_s, detail)


def template() -> Floats:
    """Angles (48,) of the template in LVLH, rad from +y towards +x; they hold the four axes."""
    return 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS


def constants(step: Step, angles: Floats, a_max: float) -> Floats:
    """const(d) of eq. (10), shape (48,), metres: a_max times the sum over steps of |([A^j B]_r)^T d|_1."""
    pushed = np.tensordot(step.response, directions(angles), axes=([1], [1]))
    return np.asarray(a_max * np.abs(pushed).sum(axis=(0, 1)))


def target_vertices(shape: CorridorShape, y_max: float) -> Floats:
    """Vertices (4, 2) of the corridor cut at ``y_max``, body axes, metres."""
    half = shape.x0 + shape.c_x * (y_max - shape.hold_radius)
    low = shape.hold_radius
    return np.array([[-shape.x0, low], [shape.x0, low], [half, y_max], [-half, y_max]])


def _vertex_margin(unit: Floats, supports: Floats, positions: Floats, target: Floats) -> Floats:
    """Largest over ``target`` (V, 2) of min over i of d_i . (q - v) + const_i, shape (P,)."""
    moved = positions @ unit.T + supports
    margin = np.full(len(positions), -np.inf)
    for vertex in target:
        np.maximum(margin, (moved - unit @ vertex).min(axis=1), out=margin)
    return margin
