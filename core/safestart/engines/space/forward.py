"""Forward sets in space by support functions: an outer polytope of the positions at the horizon, from every start.

In template directions d (unit, 98 of them) no position at T lies beyond h(d) = d . r(T; x, 0) + max over u of d . B u
(paper 000, eq. 10, unrolled). A start is in the set iff this polytope meets the polyhedron of the faces at T: an outer
approximation of :class:`~safestart.engines.space.reach.Backward`, whose thrusts it takes. The margin is the largest m
for which a point of the polytope keeps m from every face: a linear program with three coordinates.
"""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from scipy.optimize import linprog

from safestart.engines.base import EngineResult, ResultCode
from safestart.engines.space.problem import PlaneProblem, boxed
from safestart.exact.space.watch import space_watch_of
from safestart.model.scenario import Floats
from safestart.runtime.progress import Context


def template() -> Floats:
    """Unit directions (98, 3): of the points of {-2..2}^3, each direction once; the six axes are among them."""
    points = np.array([p for p in product(range(-2, 3), repeat=3) if any(p)], dtype=np.float64)
    units = points / np.linalg.norm(points, axis=1)[:, None]
    out: Floats = np.unique(units.round(12), axis=0)
    out /= np.linalg.norm(out, axis=1)[:, None]
    return out


class Forward:
    """Outer approximation in the template's directions."""

    def solve(self, problem: PlaneProblem, context: Context) -> EngineResult:
        """Margin (m) of every start; ``arrays`` holds it before the restriction."""
        begin = time.perf_counter()
        question = replace(problem.question, thrust=boxed(problem.question.thrust))
        watch, directions = space_watch_of(question), template()
        faces = np.arange(len(watch.names))
        rows = watch.cuts(np.full(len(faces), question.horizon), faces)
        start, push = watch.position_rows(question.horizon, directions)
        by_interval = push.reshape(len(directions), -1, question.channels)
        reach = question.thrust_scale * question.thrust_set.support(by_interval)
        # Faces at T as rows over the position: the start's rows are the normals times the transition's.
        normals = watch.normals_at(question.horizon)
        matrix = np.column_stack(
            [np.concatenate([directions, normals]), np.zeros(len(directions) + len(faces))]
        )
        matrix[len(directions) :, 3] = 1.0
        bounds = [(None, None)] * 4
        states = problem.states().reshape(-1, 6)
        margin = np.empty(len(states))
        detail: dict[str, Any] = {
            "set": "fixed",
            "input": "box" if question.thrust.kind == "box" else "thrusters",
            "directions": len(directions),
            "steps": question.steps,
        }
        for k, state in enumerate(states):
            limits = np.concatenate([start @ state + reach, rows.offset])
            found = linprog([0.0, 0.0, 0.0, -1.0], matrix, limits, bounds=bounds, method="highs")
            context.step(k + 1, len(states), "starts")
            if found.x is None:
                run, message = time.perf_counter() - begin, f"the linear program ended with {found.message}"
                return EngineResult(ResultCode.NUMERICAL_FAILURE, None, None, run, 0.0, message, detail)
            margin[k] = found.x[3]
        reached = margin.reshape(problem.shape)
        mask, restricted = problem.restricted(reached)
        run, arrays = time.perf_counter() - begin, {"margin_unrestricted": reached}
        return EngineResult(ResultCode.OK, mask, restricted, run, detail=detail, arrays=arrays)
