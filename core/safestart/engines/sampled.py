"""Zero-order-hold response of the planar CWH model over the steps of a problem, shared by sampled engines."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from safestart.attitude.spin import Spin
from safestart.dynamics.cwh import Cwh
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.engines.region import restrict, start_velocity
from safestart.errors import invalid
from safestart.model.scenario import Floats, SetKind
from safestart.optim.prediction import responses

MAX_STEPS = 4000


@dataclass(frozen=True, slots=True)
class Step:
    """Position response at step k, LVLH axes.

    ``drift`` (2, 2) maps the start position to the position without thrust, ``response`` (k, 2, 2) holds
    [A^j B]_r for j = 0..k-1, ``theta`` is the corridor's angle omega_t k dt (rad).
    """

    index: int
    theta: float
    drift: Floats
    response: Floats


def steps(problem: Problem) -> Iterator[Step]:
    """The steps that count: the last one (fixed time), or all from 0 on (tube)."""
    n, count, dt = problem.scenario.target.mean_motion, problem.steps, problem.dt
    if count > MAX_STEPS:
        raise invalid("dt", f"at most {MAX_STEPS} control intervals in the horizon", dt)
    starts = np.concatenate([np.eye(2), start_velocity(problem.scenario, problem.rest)])
    drift, response = (part[:, :2] for part in responses(Cwh(n), dt, count, starts))
    for k in range(count + 1) if problem.kind is SetKind.TUBE else (count,):
        yield Step(k, problem.scenario.target.tumble_rate * dt * k, drift[k], response[:k])


def to_body(vectors: Floats, theta: float) -> Floats:
    """R_z(-theta) applied to the rows of ``vectors`` (..., 2)."""
    return np.asarray(vectors @ np.ascontiguousarray(Spin(0.0).turned_by(np.asarray(theta))[:2, :2].T))


def finish(
    problem: Problem, margin: Floats, start: float, compile_s: float, detail: Mapping[str, object]
) -> EngineResult:
    """Result of a sampled engine from its unrestricted margins (P,) and the clock at its start (s)."""
    field = margin.reshape(problem.grid.ny, problem.grid.nx)
    if not np.isfinite(field).all():
        run = time.perf_counter() - start
        code, message = ResultCode.NUMERICAL_FAILURE, "the margin is not finite"
        return EngineResult(code, None, None, run, compile_s, message, detail)
    mask, restricted = restrict(problem, field)
    run = time.perf_counter() - start
    arrays = {"margin_unrestricted": field}
    return EngineResult(ResultCode.OK, mask, restricted, run, compile_s, detail=detail, arrays=arrays)
