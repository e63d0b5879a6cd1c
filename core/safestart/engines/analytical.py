"""The closed forms behind the engine interface: the sound certificate, and the conditions of paper 000."""

from __future__ import annotations

import math
import time
from typing import Any

from safestart.closed_form import certified, paper
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.runtime.progress import Context


class Certified:
    """The region of the sound certificate, whatever the horizon: GO is for ever (docs/theory/certified.md)."""

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Certify the whole grid at once."""
        start = time.perf_counter()
        answer = certified.certify_grid(problem.scenario, problem.grid, problem.rest)
        return _result(answer, time.perf_counter() - start, {"rest": problem.rest.value}, context)


class Analytical:
    """S_ana, the paper's conditions, eqs. (8) and (9), whatever the horizon; not sound (docs/theory/closed-form.md)."""

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Certify the whole grid at once."""
        start = time.perf_counter()
        answer = paper.certify_grid(problem.scenario, problem.grid, problem.rest)
        run, limit = time.perf_counter() - start, answer.range_limit
        detail = {"range_limit_m": limit if math.isfinite(limit) else None, "rest": problem.rest.value}
        return _result(answer, run, detail, context)


def _result(
    answer: certified.CertifiedMap | paper.MapCertificate,
    run_s: float,
    detail: dict[str, Any],
    context: Context,
) -> EngineResult:
    context.step(1, 1)
    return EngineResult(ResultCode.OK, answer.mask, answer.margin, run_s, detail=detail)
