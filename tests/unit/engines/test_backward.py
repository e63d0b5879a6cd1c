"""The backward engine against HiGHS, its union over steps, and the exact disk-input sets around it."""

import math
from functools import partial

import numpy as np
import pytest
from scipy.optimize import linprog

from benchmarks.peers.highs_lp import BackwardLP, slack_map
from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.engines.backward import Backward
from safestart.engines.backward_options import BackwardInput
from safestart.engines.base import Problem, ResultCode
from safestart.engines.sampled import steps, to_body
from safestart.errors import InvalidInput
from safestart.model.scenario import (
    Bools,
    Chaser,
    CorridorShape,
    Floats,
    Grid,
    Rest,
    Scenario,
    SetKind,
    Target,
)
from safestart.runtime.progress import Context
from safestart.sets import zonotope
from tests.unit.sets.exact_margin import reach_margin
from tests.unit.sets.support_twin import disk_support

NARROW = Scenario(Target(math.radians(4.0)), Chaser(0.05), CorridorShape(c_x=0.4, x0=0.0, hold_radius=3.0))
OTHERS = {
    "1 deg/s": Problem(Scenario.of(1.0, 0.1)),
    "5 deg/s, body rest": Problem(Scenario.of(5.0, 0.1), rest=Rest.BODY),
    "no tumble, weak": Problem(Scenario.of(0.0, 0.001)),
    "no orbit, few long steps": Problem(Scenario.of(3.0, 0.1, mean_motion=0.0), horizon=40.0, dt=8.0),
    "narrow": Problem(NARROW, Grid(31, 31, 60.0), 20.0, 1.0),
    "long": Problem(Scenario.of(0.2, 0.01, mean_motion=1.3e-3), Grid(31, 31, 8000.0), 900.0, 60.0),
}


def unrestricted(problem: Problem) -> Floats:
    return Backward().solve(problem, Context()).arrays["margin_unrestricted"]


def mask(problem: Problem) -> Bools:
    found = Backward().solve(problem, Context()).mask
    assert found is not None
    return found


class TestLinearProgram:
    def test_whole_map(self) -> None:
        problem = Problem(Scenario.of(3.0, 0.1))
        slack, margin = slack_map(problem), unrestricted(problem)
        clear = np.abs(slack) > 1e-7
        assert clear.sum() > 950
        np.testing.assert_array_equal((margin >= 0.0)[clear], (slack >= 0.0)[clear])
        assert 0 < (margin >= 0.0).sum() < margin.size

    @pytest.mark.parametrize("case", OTHERS)
    def test_random_cells(self, case: str) -> None:
        problem = OTHERS[case]
        margin, points = unrestricted(problem).ravel(), problem.points().reshape(-1, 2)
        program = BackwardLP(problem)
        nearest = np.argsort(np.abs(margin))[:20]
        chosen = np.concatenate([nearest, np.random.default_rng(2).choice(len(points), 30, replace=False)])
        for i in chosen:
            slack = program.slack(points[i])
            if abs(slack) > 1e-7:
                assert (slack >= 0.0) == (margin[i] >= 0.0)

    def test_hot_start_gives_the_same_slacks(self) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), Grid(5, 5))
        np.testing.assert_allclose(slack_map(problem, hot=True), slack_map(problem), atol=1e-9)


class TestAgainstTheDisk:
    @pytest.mark.parametrize("rest", Rest)
    @pytest.mark.parametrize("rate", [0.0, 1.0, 3.0, 5.0])
    def test_between_two_disks(self, rate: float, rest: Rest) -> None:
        """A held box input lies inside the free disk of radius sqrt(2) a_max.

        The free disk of radius a_max is not in general inside the held box (see below), but with 20 holds over
        40 s all it could lose is of second order in n dt: far below a millimetre.
        """
        problem = Problem(Scenario.of(rate, 0.1), rest=rest)
        margin = unrestricted(problem)
        wide = reach_margin(
            Scenario.of(rate, 0.1 * math.sqrt(2.0)), problem.points(), 40.0, rest, SetKind.FIXED
        )
        disk = reach_margin(problem.scenario, problem.points(), 40.0, rest, SetKind.FIXED)
        assert (margin <= wide + 1e-9).all()
        assert (margin >= disk - 1e-3).all()
        assert (margin - disk).max() > 1.0

    def test_the_disk_is_not_always_inside_the_held_box(self) -> None:
        """One long hold cannot follow the turning of the best thrust: in some directions the disk wins."""
        n, time = 1.3e-3, 600.0
        angles = np.linspace(0.0, np.pi, 721)
        disk = disk_support(partial(planar_transition, n), time, 1.0, angles)
        unit = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        box = zonotope.support(planar_input(n, time)[:2].T, unit)
        assert (box / disk).min() < 0.999
        assert (box / disk).max() > 1.3


class TestTube:
    @pytest.mark.parametrize("rest", Rest)
    def test_is_the_union_over_the_steps(self, rest: Rest) -> None:
        scenario, grid = Scenario.of(5.0, 0.1), Grid(13, 13)
        tube = unrestricted(Problem(scenario, grid, 12.0, 2.0, rest, SetKind.TUBE))
        points = grid.points(scenario.corridor)
        fixed = [unrestricted(Problem(scenario, grid, 2.0 * k, 2.0, rest)) for k in range(1, 7)]
        now = reach_margin(scenario, points, 1e-9, rest, SetKind.FIXED)
        np.testing.assert_allclose(tube, np.max([now, *fixed], axis=0), atol=1e-6)

    def test_is_the_whole_corridor(self) -> None:
        problem = Problem(Scenario.of(5.0, 0.1), kind=SetKind.TUBE)
        np.testing.assert_array_equal(mask(problem), problem.inside())


def test_more_holds_reach_more() -> None:
    """Halving the control interval refines the held inputs, so no start is lost."""
    scenario = Scenario.of(3.0, 0.1)
    coarse, fine = (unrestricted(Problem(scenario, Grid(), 40.0, dt)) for dt in (4.0, 2.0))
    assert (fine >= coarse - 1e-9).all()


def test_numerical_failure_is_a_result_code(monkeypatch: pytest.MonkeyPatch) -> None:
    from safestart.engines import backward

    monkeypatch.setattr(backward, "to_body", lambda vectors, theta: np.full(vectors.shape, np.nan))
    result = Backward().solve(Problem(Scenario.of(3.0, 0.1)), Context())
    assert result.code is ResultCode.NUMERICAL_FAILURE
    assert result.mask is None


def test_too_many_steps_are_refused() -> None:
    with pytest.raises(InvalidInput, match="control intervals"):
        Backward().solve(Problem(Scenario.of(3.0, 0.1), horizon=3600.0, dt=0.5), Context())


@pytest.mark.parametrize("name", [*OTHERS, "wide error"])
def test_robust_set_is_that_of_the_program_with_every_face_moved(name: str) -> None:
    """Against HiGHS: one input history that keeps all disturbed ends on the inner side of each face."""
    problem = OTHERS.get(name, Problem(Scenario.of(3.0, 0.1)))
    strength = (0.3 if name == "wide error" else 0.03) * problem.scenario.chaser.max_acceleration
    field = Backward(BackwardInput(disturbance_m_s2=strength)).solve(problem, Context())
    assert field.mask is not None
    nominal = mask(problem)
    assert not (field.mask & ~nominal).any()
    margin = field.arrays["margin_unrestricted"].ravel()
    (step,) = [each for each in steps(problem)][-1:]
    turned = to_body(step.response.transpose(0, 2, 1).reshape(-1, 2), step.theta)
    corridor = corridor_of(problem.scenario.corridor)
    lost = strength * np.abs(corridor.normals @ turned.T).sum(axis=1)
    places = problem.points().reshape(-1, 2) @ to_body(step.drift.T, step.theta)
    rows = corridor.normals @ turned.T
    limit = problem.scenario.chaser.max_acceleration
    for cell in np.argsort(np.abs(margin))[:: max(1, len(margin) // 25)]:
        # The largest slack that one history leaves to all faces together.
        count = rows.shape[1]
        found = linprog(
            np.append(np.zeros(count), -1.0),
            A_ub=np.column_stack([rows, np.ones(len(rows))]),
            b_ub=corridor.offsets - lost - corridor.normals @ places[cell],
            bounds=[(-limit, limit)] * count + [(None, None)],
        )
        slack = -found.fun
        assert abs(slack) < 1e-6 or (slack >= 0.0) == (margin[cell] >= 0.0)


def test_no_disturbance_is_the_nominal_set_to_the_bit() -> None:
    problem = Problem(Scenario.of(3.0, 0.1))
    same = Backward(BackwardInput(disturbance_m_s2=0.0)).solve(problem, Context())
    np.testing.assert_array_equal(same.arrays["margin_unrestricted"], unrestricted(problem))
    tiny = Backward(BackwardInput(disturbance_m_s2=1e-9)).solve(problem, Context())
    np.testing.assert_allclose(tiny.arrays["margin_unrestricted"], unrestricted(problem), atol=1e-5)
