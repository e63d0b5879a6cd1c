"""The velocity-aware target of the level set: its function, its limits, and the set against cone programs."""

from typing import Any

import numpy as np
import pytest

from safestart.attitude.body_frame import body_to_lvlh
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.engines.hamilton_jacobi import HamiltonJacobi
from safestart.engines.hj.domain import size_domain
from safestart.engines.hj.frame import Frame
from safestart.engines.hj.options import HamiltonJacobiInput
from safestart.engines.hj.settings import Settings
from safestart.engines.hj.target import TargetValues, mismatch, target_at
from safestart.errors import InvalidInput
from safestart.model.scenario import Grid, Rest, Scenario, SetKind
from safestart.runtime.progress import Context
from tests.unit.engines.match_twin import reaches

SMALL = HamiltonJacobiInput(accuracy="low", nodes_xy=17, nodes_v=9)


def _problem(
    rate: float = 3.0,
    kind: SetKind = SetKind.TUBE,
    grid: Grid | None = None,
    horizon: float = 10.0,
) -> Problem:
    return Problem(Scenario.of(rate, 0.1), grid or Grid(21, 21, 40.0), horizon, 2.0, Rest.LVLH, kind)


def _solve(problem: Problem, match: float | None = 0.5, options: HamiltonJacobiInput = SMALL) -> EngineResult:
    result = HamiltonJacobi(options, match=match).solve(problem, Context())
    assert result.code is ResultCode.OK, result.message
    return result


def test_a_co_rotating_point_of_the_corridor_is_in_the_target_in_both_frames() -> None:
    rate, point = 0.05, np.array([3.0, 20.0])
    at, velocity = body_to_lvlh(point, np.zeros(2), rate, 0.0)
    for turn in (0.0, 1.0, 2.5):
        # The same body-fixed point after a turn: the difference of the velocities keeps its length.
        at, velocity = body_to_lvlh(point, np.array([0.3, 0.4]), rate, turn / rate)
        found = mismatch(np.concatenate([at, velocity]), rate, Frame.LVLH, 0.2)
        assert found == pytest.approx(30.0 * (0.5 - 0.2))
    body = mismatch(np.concatenate([point, [0.3, 0.4]]), rate, Frame.BODY, 0.2)
    assert body == pytest.approx(30.0 * (0.5 - 0.2))


def test_target_values_are_the_larger_of_distance_and_mismatch() -> None:
    problem = _problem()
    settings = Settings.of(problem, SMALL, 0.5)
    domain = size_domain(problem, settings.frame)
    values = TargetValues.of(problem, domain, settings)
    x, y, vx, vy = domain.axes(settings.shape)
    for i, j, k, m in ((3, 13, 2, 6), (8, 10, 4, 4), (8, 11, 4, 3), (16, 0, 8, 8)):
        state = np.array([x[i], y[j], vx[k], vy[m]])
        assert values.first[i, j, k, m] == pytest.approx(float(target_at(problem, settings, state)))
    plain = Settings.of(problem, SMALL)
    assert (values.first >= TargetValues.of(problem, domain, plain).first).all()
    # tau times the match is the most that can be to spare.
    assert -15.0 <= values.low <= values.first.min()


@pytest.mark.parametrize(
    ("frame", "kind"), [("lvlh", SetKind.TUBE), ("body", SetKind.TUBE), ("lvlh", SetKind.FIXED)]
)
def test_asking_for_more_gives_less(frame: str, kind: SetKind) -> None:
    """Inside the position-only set, and larger for a looser match; a match that every speed meets asks for nothing."""
    problem, options = _problem(kind=kind), SMALL.model_copy(update={"frame": frame})
    loose, tight, free, anything = (
        _solve(problem, match, options).arrays["margin_unrestricted"] for match in (2.0, 0.5, None, 900.0)
    )
    assert (tight <= loose + 1e-2).all()
    assert (loose <= free + 1e-2).all()
    assert (tight < free - 1.0).any()
    np.testing.assert_allclose(anything, free, atol=1e-2)


def test_without_tumble_rest_matches_at_once() -> None:
    problem = _problem(rate=0.0)
    np.testing.assert_array_equal(_solve(problem).mask, problem.inside())


def test_against_cone_programs() -> None:
    """No start too many; of 50 a coarse grid finds 39 (31 x 31 x 13 x 13 with very_high: 44)."""
    problem = _problem(grid=Grid(21, 21, 80.0), horizon=20.0)
    options = HamiltonJacobiInput(accuracy="high", nodes_xy=25, nodes_v=11)
    inside = problem.inside()
    expected = np.zeros(inside.shape, dtype=bool)
    expected[inside] = reaches(problem.scenario, problem.points()[inside], 20.0, 0.5)
    found = _solve(problem, options=options).mask
    assert found is not None
    assert expected.sum() == 50
    assert not (found & ~expected).any()
    assert found.sum() >= 36


@pytest.mark.parametrize("match", [0.0, -1.0, float("nan"), "fast", True, 2e3])
def test_bad_matches_are_refused(match: Any) -> None:
    with pytest.raises(InvalidInput, match="match"):
        HamiltonJacobi(match=match)
