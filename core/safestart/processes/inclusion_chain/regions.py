"""The sets of the chain on one grid: cells inside, cells outside, and their margins."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from safestart.atlas.survey import build
from safestart.closed_form.by_name import ClosedForm, map_of
from safestart.disturbance.tube import Disturbance, Tube, tube_of
from safestart.engines.base import Engine, Problem, ResultCode
from safestart.engines.exact import Exact
from safestart.engines.hamilton_jacobi import HamiltonJacobi
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Bools, Floats, Rest, Scenario, SetKind
from safestart.processes.inclusion_chain.spec import ChainInputs
from safestart.processes.wire import DT_S
from safestart.runtime.progress import Context


@dataclass(frozen=True, slots=True)
class Region:
    """A set on the grid, arrays (ny, nx); cells neither ``inside`` nor ``outside`` are undecided.

    ``margin`` in metres, NaN where unknown; for questions it is the proved bound behind the verdict. ``question``
    decides single starts with a proof. Unless ``code`` is OK both masks are empty.
    """

    name: str
    inside: Bools
    outside: Bools
    margin: Floats
    run_s: float
    code: ResultCode = ResultCode.OK
    message: str = ""
    question: Question | None = None
    detail: dict[str, Any] = field(default_factory=dict)


def region_of(name: str, inputs: ChainInputs, corridor: Bools, context: Context) -> Region:
    """Compute one set; a failure is a code with empty masks."""
    begin = time.perf_counter()
    found = _SETS[name](name, inputs, corridor, context)
    return found if found.run_s else replace(found, run_s=time.perf_counter() - begin)


def question_of(name: str, inputs: ChainInputs, steps: int | None = None) -> Question:
    """`stay`, or `synchronize` within any number of intervals up to ``steps`` (absent: the horizon)."""
    steps = round(inputs.horizon_s / DT_S) if steps is None else steps
    goal = Goal(inputs.ball_radius_m, inputs.rest_speed_m_s) if name == "synchronize" else None
    return Question(inputs.scenario(), DT_S, steps, goal=goal)


def state_at(points: Floats) -> Floats:
    """States (..., 4) of starts (..., 2) at rest in LVLH."""
    return np.concatenate([points, np.zeros_like(points)], axis=-1)


def _failed(name: str, shape: tuple[int, ...], code: ResultCode, message: str, **detail: Any) -> Region:
    none = np.zeros(shape, dtype=np.bool_)
    return Region(name, none, none, np.full(shape, np.nan), 0.0, code, message, None, detail)


def _analytical(name: str, inputs: ChainInputs, corridor: Bools, context: Context) -> Region:
    context.step(0, 1)
    form: ClosedForm = "certified" if name == "certified" else "paper"
    return _closed_form(name, form, inputs.scenario(), inputs, corridor)


def _closed_form(
    name: str, form: ClosedForm, scenario: Scenario, inputs: ChainInputs, corridor: Bools
) -> Region:
    found = map_of(form, scenario, inputs.grid.grid())
    inside = found.mask & corridor
    return Region(name, inside, corridor & ~inside, found.margin, 0.0)


def _tube(inputs: ChainInputs) -> tuple[Tube, dict[str, Any]]:
    tube = tube_of(question_of("stay", inputs), Disturbance(inputs.disturbance_m_s2))
    radius, thrust = (value if math.isfinite(value) else None for value in (tube.radius, tube.thrust))
    return tube, {
        "disturbance_m_s2": inputs.disturbance_m_s2,
        "radius_m": radius,
        "feedback_m_s2": thrust,
    }


def _tightened(name: str, inputs: ChainInputs, corridor: Bools, context: Context) -> Region:
    tube, detail = _tube(inputs)
    if tube.question is None:
        # The tube leaves no room for a plan, so the set is known to be empty.
        none = np.zeros(corridor.shape, dtype=np.bool_)
        margin = np.full(corridor.shape, np.nan)
        return Region(name, none, corridor, margin, 0.0, ResultCode.OK, tube.reason, None, detail)
    if name == "analytical_tube":
        found = _closed_form(name, "paper", tube.question.scenario, inputs, corridor)
        return Region(name, found.inside, found.outside, found.margin, 0.0, detail=detail)
    return _by_atlas(name, tube.question, inputs, corridor, context, detail)


def _stay(name: str, inputs: ChainInputs, corridor: Bools, context: Context) -> Region:
    return _by_atlas(name, question_of(name, inputs), inputs, corridor, context, {})


def _by_atlas(
    name: str,
    question: Question,
    inputs: ChainInputs,
    corridor: Bools,
    context: Context,
    detail: dict[str, Any],
) -> Region:
    """`stay` on the grid: an atlas, and a program for each cell in its undecided strip."""
    grid = inputs.grid.grid()
    points = grid.points(inputs.scenario().corridor)
    y_max = max(grid.y_max, question.scenario.corridor.hold_radius + 1.0)
    lower, upper = build(question, y_max).bounds(points)
    inside, outside = (lower > 0.0) & corridor, (upper < 0.0) & corridor
    margin = np.where(inside, lower, np.where(outside, upper, np.nan))
    return _one_by_one(name, question, points, corridor, inside, outside, margin, context, detail)


def _synchronize(name: str, inputs: ChainInputs, corridor: Bools, context: Context) -> Region:
    points = inputs.grid.grid().points(inputs.scenario().corridor)
    none = np.zeros(corridor.shape, dtype=np.bool_)
    margin = np.full(corridor.shape, np.nan)
    detail = {
        "ball_radius_m": inputs.ball_radius_m,
        "rest_speed_m_s": inputs.rest_speed_m_s,
    }
    question = question_of(name, inputs)
    return _one_by_one(name, question, points, corridor, none, none.copy(), margin, context, detail)


def _one_by_one(
    name: str,
    question: Question,
    points: Floats,
    corridor: Bools,
    inside: Bools,
    outside: Bools,
    margin: Floats,
    context: Context,
    detail: dict[str, Any],
) -> Region:
    """Decide the open cells; fills ``inside``, ``outside`` and ``margin`` in place."""
    left = np.argwhere(corridor & ~inside & ~outside)
    reasons: dict[str, int] = {}
    for k, (row, column) in enumerate(left.tolist()):
        answer = decide(question, state_at(points[row, column]), verdict_only=True)
        inside[row, column] = answer.verdict is Verdict.GO
        outside[row, column] = answer.verdict is Verdict.NO_GO
        margin[row, column] = answer.margin_m
        if answer.verdict is Verdict.UNDECIDED:
            reasons[answer.reason] = reasons.get(answer.reason, 0) + 1
        context.step(k + 1, len(left), "starts")
    message = "; ".join(f"{count} undecided: {reason}" for reason, count in reasons.items())
    return Region(name, inside, outside, margin, 0.0, ResultCode.OK, message, question, detail)


def _engine(name: str, inputs: ChainInputs, corridor: Bools, context: Context) -> Region:
    exact = name == "exact_position"
    match = inputs.match_m_s if name == "hj_match" else None
    engine: Engine = Exact() if exact else HamiltonJacobi(inputs.hamilton_jacobi, match=match)
    problem = Problem(
        inputs.scenario(),
        inputs.grid.grid(),
        inputs.horizon_s,
        DT_S,
        Rest.LVLH,
        SetKind.FIXED if exact else SetKind.TUBE,
    )
    result = engine.solve(problem, context)
    if result.mask is None or result.margin is None:
        return _failed(name, corridor.shape, result.code, result.message, **dict(result.detail))
    detail = dict(result.detail) | {"compile_s": result.compile_s}
    outside = corridor & ~result.mask
    return Region(
        name, result.mask, outside, result.margin, result.run_s, message=result.message, detail=detail
    )


_SETS: dict[str, Callable[[str, ChainInputs, Bools, Context], Region]] = {
    "tube": _tightened,
    "analytical_tube": _tightened,
    "certified": _analytical,
    "analytical": _analytical,
    "synchronize": _synchronize,
    "stay": _stay,
    "hj_match": _engine,
    "hj_position": _engine,
    "exact_position": _engine,
}
