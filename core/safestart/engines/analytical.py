"""The closed-form certificate behind the engine interface (paper 000, eqs. 8 and 9)."""

from __future__ import annotations

import math
import time

from safestart.closed_form.paper import certify_grid
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.runtime.progress import Context


class Analytical:
    """The certificate's region, whatever the horizon; nearly sound (see docs/theory/closed-form.md), partial."""

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Certify the whole grid at once."""
        start = time.perf_counter()
        answer = certify_grid(problem.scenario, problem.grid, problem.rest)
        run = time.perf_counter() - start
        context.step(1, 1)
        limit = answer.range_limit
        detail = {"range_limit_m": limit if math.isfinite(limit) else None, "rest": problem.rest.value}
        return EngineResult(ResultCode.OK, answer.mask, answer.margin, run, detail=detail)
