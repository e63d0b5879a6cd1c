"""The engines on a plane of starts in space: the planar engines, the exact question, and inclusion as oracles."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from safestart.attitude.in_lvlh import torque_free
from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ThrustLimit, ball
from safestart.engines.backward import Backward as PlanarBackward
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.engines.registry import ENGINES, why_not_in_space
from safestart.engines.space.forward import template
from safestart.engines.space.problem import PlaneProblem, engine_in_space
from safestart.engines.space.sequence import later
from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.plane import Plane
from safestart.exact.space.question import Face, SpaceQuestion, five_faces
from safestart.exact.space.watch import space_watch_of
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import CorridorShape, Grid, Rest, Scenario, SetKind
from safestart.runtime.progress import Context
from tests.unit.sets.exact_margin import reach_margin

CORRIDOR = five_faces(CorridorShape())
BODY = ((120.0, 2.0, -1.0), (2.0, 100.0, 3.0), (-1.0, 3.0, 60.0))
ORBIT = KeplerOrbit.of(2.4e7, 0.7, 0.2)
SIX = tuple((float(x), float(y), float(z)) for x, y, z in np.vstack([np.eye(3), -np.eye(3)]))
LOW = KeplerOrbit(1.1e-3)
UNEVEN, ARMS = ThrustLimit("box", (0.05, 0.1, 0.02), frame="body"), ThrustLimit("thrusters", (0.08,) * 6, SIX)
TUMBLE = torque_free(BODY, (1.0, 0.0, 0.0, 0.0), (0.01, -0.02, 0.04), "lvlh", ORBIT)
LVLH_FACE = Face("plane", (0.0, 1.0, 0.3), 70.0, "lvlh")


def positions(a: int, b: int, low: tuple[float, float], high: tuple[float, float]) -> Plane:
    return Plane(np.array([0.0, 0, 0, 0, 0, 0]), np.eye(6)[:, [a, b]], np.array(low), np.array(high))


QUESTIONS = {
    "tumble": SpaceQuestion(ORBIT, TUMBLE, (*CORRIDOR, LVLH_FACE), ball(0.05), steps=15),
    "box": SpaceQuestion(LOW, Spin(0.05, (0.2, 0.1, 1.0)), CORRIDOR, UNEVEN, steps=15),
    "thrusters": SpaceQuestion(LOW, Spin(-0.05), CORRIDOR, ARMS, steps=15),
}
PLANES = {
    "positions": positions(0, 1, (-80.0, 1.0), (80.0, 69.0)),
    "position and velocity": Plane(
        np.array([0.0, 25.0, 0, 0, 0, 0]),
        np.eye(6)[:, [2, 4]],
        np.array([-40.0, -3.0]),
        np.array([40.0, 3.0]),
    ),
}


@cache
def solved(question: str, plane: str, engine: str) -> EngineResult:
    problem = PlaneProblem(QUESTIONS[question], PLANES[plane], 7, 9)
    found = engine_in_space(engine).solve(problem, Context())
    assert found.code is ResultCode.OK
    return found


@pytest.mark.parametrize("rate", [1.0, 4.0])
@pytest.mark.parametrize("rest", list(Rest))
def test_in_the_plane_backward_is_the_planar_engine_s(rate: float, rest: Rest) -> None:
    grid = Grid(9, 9, 120.0)
    scenario = Scenario.of(rate, 0.05)
    planar = PlanarBackward().solve(Problem(scenario, grid, 40.0, 2.0, rest, SetKind.FIXED), Context())
    spin = Spin(math.radians(rate))
    question = SpaceQuestion(KeplerOrbit(1.1e-3), spin, CORRIDOR, ball(0.05), steps=20)
    x, y = grid.axes(scenario.corridor)
    plane = positions(0, 1, (x[0], y[0]), (x[-1], y[-1]))
    if rest is Rest.BODY:
        plane.columns[4, 0], plane.columns[3, 1] = spin.rate, -spin.rate
    problem = PlaneProblem(question, plane, 9, 9)
    found = engine_in_space("backward").solve(problem, Context())
    # Corners of the grid lie on faces: rounding decides there.
    clear = np.abs(problem.distance()) > 1e-9
    np.testing.assert_array_equal(found.mask[clear], planar.mask[clear])
    # One margin is a distance between sets, the other the least of face distances: they have the same sign.
    lost = planar.arrays["margin_unrestricted"]
    clear = np.abs(lost) > 1e-6
    np.testing.assert_array_equal(found.arrays["margin_unrestricted"][clear] > 0.0, lost[clear] > 0.0)
    assert 0 < (lost > 0.0).sum() < lost.size


def test_in_the_plane_exact_is_a_little_less_than_continuous_thrust() -> None:
    """The planar engine's thrust may change at any time; held over 2 s it reaches at most half a metre less here."""
    scenario = Scenario.of(3.0, 0.1)
    held = SpaceQuestion(LOW, Spin(math.radians(3.0)), CORRIDOR, ball(0.1), steps=20)
    problem = PlaneProblem(held, positions(0, 1, (-100.0, 0.0), (100.0, 120.0)), 11, 11)
    free = reach_margin(scenario, problem.states()[..., :2], 40.0, kind=SetKind.FIXED)
    found = engine_in_space("exact").solve(problem, Context()).arrays["margin_unrestricted"]
    assert (free[found > 0.0] > -1e-4).all()
    assert (found[free > 0.5] > 0.0).all()
    assert 0 < (free > 0.5).sum() < free.size


@pytest.mark.parametrize("plane", sorted(PLANES))
@pytest.mark.parametrize("question", sorted(QUESTIONS))
def test_sets_lie_in_one_another(question: str, plane: str) -> None:
    exact, forward = (solved(question, plane, name).mask for name in ("exact", "forward"))
    flown = solved(question, plane, "monte_carlo").mask
    assert not (flown & ~exact).any()
    assert not (exact & ~forward).any()
    if question != "thrusters":
        backward = solved(question, plane, "backward").mask
        assert not (exact & ~backward).any()
        assert not (backward & ~forward).any()
    # A comparison of empty or of full sets would say nothing.
    assert 0 < flown.sum() < exact.size


@pytest.mark.parametrize("question", ["tumble", "thrusters"])
def test_without_noise_what_is_flown_is_what_can_stay(question: str) -> None:
    asked = QUESTIONS[question]
    problem = PlaneProblem(asked, PLANES["positions"], 7, 9)
    flown = solved(question, "positions", "monte_carlo")
    for state, kept, margin in zip(
        problem.states().reshape(-1, 6), flown.mask.ravel(), flown.margin.ravel(), strict=True
    ):
        answer = decide_in_space(asked, state)
        if abs(answer.margin_m) > 1e-3:
            assert kept == (answer.verdict is Verdict.GO)
        if kept:
            # The controller stops a centimetre from the best flight.
            assert answer.upper - 0.02 <= margin <= answer.upper + 1e-5


def test_noise_is_drawn_by_case_and_costs_margin() -> None:
    problem = PlaneProblem(QUESTIONS["box"], PLANES["positions"], 5, 5, (0.3, 0.03), 7)
    first, again = (engine_in_space("monte_carlo").solve(problem, Context()) for _ in range(2))
    np.testing.assert_array_equal(first.margin, again.margin)
    other = engine_in_space("monte_carlo").solve(replace(problem, seed=8), Context())
    still = engine_in_space("monte_carlo").solve(replace(problem, sigma=(0.0, 0.0)), Context())
    kept = still.mask & (still.margin < 20.0)
    assert (other.margin != first.margin).any()
    assert first.margin[kept].mean() < still.margin[kept].mean()
    assert first.detail["plans"] > still.detail["plans"]


@pytest.mark.parametrize("question", sorted(QUESTIONS))
def test_the_rest_of_a_question_is_the_same_flight(question: str) -> None:
    asked = QUESTIONS[question]
    rng, state = np.random.default_rng(3), np.array([2.0, 25.0, 1.0, 0.1, -0.1, 0.0])
    points = rng.uniform(0.0, 1.0 / 6.0, size=(asked.steps, asked.channels)) * asked.thrust_scale
    whole, tail = space_watch_of(asked), space_watch_of(later(asked, 6))
    flown = whole.flown(state, points)
    at = int(np.nonzero(whole.intervals == 6)[0][0])
    np.testing.assert_allclose(tail.flown(flown[at], points[6:]), flown[at:], atol=1e-9)
    np.testing.assert_allclose(tail.normals_at(4.0), whole.normals_at(16.0), atol=1e-12)


def test_the_template_holds_the_axes_and_no_direction_twice() -> None:
    found = template()
    assert found.shape == (98, 3)
    assert all(np.abs(found - axis).sum(axis=1).min() < 1e-15 for axis in np.vstack([np.eye(3), -np.eye(3)]))
    assert (found @ found.T - 2.0 * np.eye(98)).max() < 0.99


def test_every_engine_answers_or_says_why_not() -> None:
    for name, spec in ENGINES.items():
        assert bool(spec.in_space) is (why_not_in_space(name, "ball") == "")
        if spec.in_space:
            assert engine_in_space(name) is not None
    assert "axis by axis" in why_not_in_space("backward", "thrusters")
    assert "planar" in why_not_in_space("hamilton_jacobi", "ball")


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"low": np.array([5.0, 0.0]), "high": np.array([5.0, 1.0])}, "low"),
        ({"columns": np.eye(6)[:, [1, 1]]}, "direction"),
        ({"origin": np.full(6, np.nan)}, "plane"),
    ],
)
def test_what_is_no_plane_is_refused(change: dict, field: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        replace(PLANES["positions"], **change)
    assert refused.value.field == field
