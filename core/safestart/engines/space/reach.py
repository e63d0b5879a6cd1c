"""Exact sets in space: starts that some thrust history brings inside all faces at the horizon.

The distances at T are affine in the start and the thrusts, so the largest of their least is one small cone program for
each start: m(x) = max over u of min over faces of b_i - a_i . C_i(T) r(T; x, u). ``exact`` takes the thrusts that are
asked; ``backward`` a box around them, as paper 000 does (section 7, "BRS"), so that its set holds the exact one.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from safestart.constraints.thrust_limit import ThrustLimit
from safestart.engines.base import EngineResult, ResultCode
from safestart.engines.space.problem import PlaneProblem, boxed
from safestart.exact.space.watch import space_watch_of
from safestart.optim.largest_margin import solve
from safestart.runtime.progress import Context


class Exact:
    """The thrusts that are asked, held over the intervals."""

    input = "as asked"

    def thrust(self, limit: ThrustLimit) -> ThrustLimit:
        """The set of thrusts."""
        return limit

    def solve(self, problem: PlaneProblem, context: Context) -> EngineResult:
        """Margin (m) of every start, the upper end of its bracket; ``arrays`` holds it before the restriction."""
        begin = time.perf_counter()
        question = replace(problem.question, thrust=self.thrust(problem.question.thrust))
        watch = space_watch_of(question)
        faces = np.arange(len(watch.names))
        rows = watch.cuts(np.full(len(faces), question.horizon), faces)
        states = problem.states().reshape(-1, 6)
        margin = np.empty(len(states))
        detail: dict[str, Any] = {"set": "fixed", "input": self.input, "steps": question.steps}
        for k, state in enumerate(states):
            found = solve(
                rows.offset + rows.start @ state,
                rows.thrust,
                question.thrust_scale,
                question.channels,
                within=question.thrust_set,
                components=3,
            )
            margin[k] = found.bound
            context.step(k + 1, len(states), "starts")
            if found.thrust is None or not np.isfinite(found.bound):
                run, message = time.perf_counter() - begin, f"the solver stopped with {found.status}"
                return EngineResult(ResultCode.NUMERICAL_FAILURE, None, None, run, 0.0, message, detail)
        reached = margin.reshape(problem.shape)
        mask, restricted = problem.restricted(reached)
        run, arrays = time.perf_counter() - begin, {"margin_unrestricted": reached}
        return EngineResult(ResultCode.OK, mask, restricted, run, detail=detail, arrays=arrays)


class Backward(Exact):
    """A box around a ball of thrusts, along LVLH axes; a box as it is."""

    input = "box"

    def thrust(self, limit: ThrustLimit) -> ThrustLimit:
        """See :class:`Exact`."""
        return boxed(limit)
