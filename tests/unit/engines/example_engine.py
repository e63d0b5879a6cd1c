"""A small engine, as docs/extending.md describes one: where co-rotation asks for no more than a speed."""

from __future__ import annotations

import math
import time

import numpy as np
from pydantic import Field

from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.engines.region import restrict
from safestart.engines.spec import EngineSpec
from safestart.model.wire_model import WireModel
from safestart.runtime.progress import Context


class SpeedInput(WireModel):
    """Options of the engine `speed`."""

    speed_m_s: float = Field(3.0, gt=0, le=100, description="Speed that the chaser trusts itself, m/s.")


SPEC = EngineSpec(
    name="speed",
    title="slow enough",
    colour="#F0E442",
    engine="tests.unit.engines.example_engine:Speed",
    summary="starts that move with the target at no more than a given speed",
    line="-.",
    options=SpeedInput,
)


class Speed:
    """A start p belongs to the set iff omega_t |p| is at most the speed."""

    def __init__(self, options: SpeedInput | None = None) -> None:
        self._speed = (options or SpeedInput()).speed_m_s

    def solve(self, problem: Problem, context: Context) -> EngineResult:
        """Margin: metres to the circle of that speed, or to the corridor's nearest face."""
        begin = time.perf_counter()
        rate = problem.scenario.target.tumble_rate
        furthest = self._speed / rate if rate > 0.0 else math.inf
        mask, margin = restrict(problem, furthest - np.hypot(*np.moveaxis(problem.points(), -1, 0)))
        context.step(1, 1)
        run_s = time.perf_counter() - begin
        return EngineResult(ResultCode.OK, mask, margin, run_s, detail={"speed_m_s": self._speed})
