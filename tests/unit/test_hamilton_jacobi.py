"""The Hamilton-Jacobi engine: model against CWH, value bounds, the exact set, failure, cancellation, bad input."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from safestart.dynamics.body_frame import body_to_lvlh, lvlh_to_body, rotation
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.engines import hamilton_jacobi, hj_domain, hj_solver
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.engines.exact import reach_margin
from safestart.engines.hamilton_jacobi import HamiltonJacobi, signed_distance
from safestart.engines.hj_model import coefficients, rotating_gradient, system_matrix
from safestart.engines.hj_settings import Settings
from safestart.errors import Cancelled, InvalidInput
from safestart.progress import Context
from safestart.scenario import CorridorShape, Grid, Rest, Scenario, SetKind, Target

SMALL = [21, 21, 9, 9]
GRID = Grid(21, 21, 40.0)


def run(
    rate: float = 3.0,
    horizon: float = 10.0,
    grid: Grid = GRID,
    rest: Rest = Rest.LVLH,
    kind: SetKind = SetKind.TUBE,
    context: Context | None = None,
    **options: Any,
) -> EngineResult:
    options = {"shape": SMALL} | options
    problem = Problem(
        Scenario.of(rate, 0.1), grid, horizon, rest=rest, kind=kind, options={"hamilton_jacobi": options}
    )
    return HamiltonJacobi().solve(problem, context or Context())


def _rk4(f: Any, state: np.ndarray, horizon: float, steps: int) -> np.ndarray:
    h = horizon / steps
    for k in range(steps):
        t = k * h
        k1 = f(t, state)
        k2 = f(t + h / 2, state + h / 2 * k1)
        k3 = f(t + h / 2, state + h / 2 * k2)
        k4 = f(t + h, state + h * k3)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return state


class TestModel:
    """Thrust constant in LVLH, so that CWH has a closed form; 40 s from 120 m with a velocity."""

    START = np.array([90.0, 80.0]), np.array([-1.5, 2.0])
    THRUST = np.array([0.06, -0.08])

    def body_flight(self, target: Target, *, whole: bool) -> np.ndarray:
        matrix = system_matrix(target)

        def f(t: float, state: np.ndarray) -> np.ndarray:
            out = matrix @ state
            out[2:] += rotation(-target.tumble_rate * t) @ self.THRUST
            if whole:
                out[2:] += rotating_gradient(target, t) @ state[:2]
            return out

        return _rk4(f, np.concatenate(self.START), 40.0, 4000)

    @pytest.mark.parametrize("rate", [0.0, 1.0, 3.0, 10.0])
    def test_with_the_rotating_term_it_is_cwh(self, rate: float) -> None:
        target = Scenario.of(rate, 0.1).target
        p, v = body_to_lvlh(*self.START, target.tumble_rate, 0.0)
        n = target.mean_motion
        flown = planar_transition(n, 40.0) @ np.concatenate([p, v]) + planar_input(n, 40.0) @ self.THRUST
        expected = np.concatenate(lvlh_to_body(flown[:2], flown[2:], target.tumble_rate, 40.0))
        np.testing.assert_allclose(self.body_flight(target, whole=True), expected, rtol=0, atol=1e-9)

    @pytest.mark.parametrize("rate", [0.0, 1.0, 3.0, 10.0])
    def test_without_it_it_is_cwh_with_an_isotropic_gradient(self, rate: float) -> None:
        """The same flight in LVLH with 3 n^2 x replaced by its mean over directions, 1.5 n^2 (x, y)."""
        target = Scenario.of(rate, 0.1).target
        n = target.mean_motion
        a = np.zeros((6, 6))
        a[0, 2] = a[1, 3] = 1.0
        a[2, 0] = a[3, 1] = 1.5 * n * n
        a[2, 3], a[3, 2] = 2.0 * n, -2.0 * n
        a[2, 4] = a[3, 5] = 1.0
        p, v = body_to_lvlh(*self.START, target.tumble_rate, 0.0)
        flown = (expm(a * 40.0) @ np.concatenate([p, v, self.THRUST]))[:4]
        expected = np.concatenate(lvlh_to_body(flown[:2], flown[2:], target.tumble_rate, 40.0))
        ours = self.body_flight(target, whole=False)
        np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-9)
        # What was dropped moves a 40 s flight from 120 m by decimetres.
        assert 1e-3 < np.abs(ours - self.body_flight(target, whole=True))[:2].max() < 0.5

    def test_no_orbit_no_tumble_is_a_double_integrator(self) -> None:
        assert coefficients(Target(0.0, 0.0)) == (0.0, 0.0)

    def test_signed_distance(self) -> None:
        shape = CorridorShape()
        points = np.array([[0.0, 0.5], [0.0, 10.0], [0.0, -3.0], [2.5 + 1.5 * 9.5, 10.0], [100.0, 10.0]])
        root = math.hypot(1.0, 1.5)
        side = (2.5 + 1.5 * 9.5) / root
        expected = [0.0, -min(9.5, side), 3.5, 0.0, (100.0 - 1.5 * 9.5 - 2.5) / root]
        np.testing.assert_allclose(signed_distance(shape, points), expected, atol=1e-12)


class TestDomain:
    @pytest.mark.parametrize("rest", list(Rest))
    def test_paper_point(self, rest: Rest) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), rest=rest)
        domain = hj_domain.size_domain(problem, Settings())
        r = math.hypot(2.5 + 1.5 * 149.5, 150.0)
        np.testing.assert_allclose(domain.half[:2], r + 80.0)
        np.testing.assert_allclose(domain.half[2:], math.radians(3.0) * r + 4.0)
        assert domain.padded_for == 40.0
        states = np.abs(hj_domain.start_states(problem)).reshape(-1, 4).max(axis=0)
        assert (states <= domain.half).all()

    def test_rest_in_lvlh_is_no_lvlh_velocity(self) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), GRID)
        states = hj_domain.start_states(problem)
        _, v = body_to_lvlh(states[..., :2], states[..., 2:], problem.scenario.target.tumble_rate, 0.0)
        np.testing.assert_allclose(v, 0.0, atol=1e-12)
        body = Problem(Scenario.of(3.0, 0.1), GRID, rest=Rest.BODY)
        np.testing.assert_array_equal(hj_domain.start_states(body)[..., 2:], 0.0)

    def test_long_horizons_do_not_widen_it_for_ever(self) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), horizon=600.0)
        domain = hj_domain.size_domain(problem, Settings())
        r = math.hypot(2.5 + 1.5 * 149.5, 150.0)
        np.testing.assert_allclose(domain.half[0], 1.5 * r)
        assert any("600 s" in text for text in hj_domain.warnings(problem, domain, Settings()))

    def test_too_many_steps_are_refused(self) -> None:
        with pytest.raises(InvalidInput, match="time steps"):
            run(horizon=3600.0, grid=Grid(5, 5, 1.0), domain={"x_m": 4.0, "y_m": 4.0, "v_m_s": 500.0})


@pytest.mark.parametrize("rate", [0.0, 3.0])
@pytest.mark.parametrize("rest", list(Rest))
def test_bounds_and_inclusions(rest: Rest, rate: float) -> None:
    """V in l's range, a tube that grows with the horizon, the fixed-time set in it, all inside the corridor."""
    tubes = [run(rate, horizon, rest=rest) for horizon in (6.0, 12.0)]
    fixed = run(rate, 12.0, rest=rest, kind=SetKind.FIXED)
    inside = Problem(Scenario.of(rate, 0.1), GRID).inside()
    for result in (*tubes, fixed):
        assert result.code is ResultCode.OK, result.message
        assert result.mask is not None
        assert not (result.mask & ~inside).any()
        detail = result.detail
        spread = detail["target_max_m"] - detail["target_min_m"]
        assert detail["value_min_m"] >= detail["target_min_m"] - 1e-3 * spread
        assert detail["value_max_m"] <= detail["target_max_m"] + 1e-3 * spread
    for tube in tubes:
        np.testing.assert_array_equal(tube.mask, inside, err_msg="a tube contains its target")
    # The automatic box grows with the horizon; one box for all makes the values comparable.
    box = {"x_m": 90.0, "y_m": 90.0, "v_m_s": 6.0}
    short, long = (
        run(rate, horizon, rest=rest, domain=box).arrays["margin_unrestricted"] for horizon in (6.0, 12.0)
    )
    at_end = run(rate, 12.0, rest=rest, kind=SetKind.FIXED, domain=box).arrays["margin_unrestricted"]
    assert (long >= short - 1e-3).all()
    assert (long >= at_end - 1e-3).all()
    assert (long > short + 0.1).any()


def _overlap(a: np.ndarray, b: np.ndarray, where: np.ndarray) -> float:
    return float((a & b & where).sum() / (a | b)[where].sum())


@pytest.mark.parametrize(("rest", "least"), [(Rest.LVLH, 0.94), (Rest.BODY, 0.83)])
def test_default_grid_against_the_exact_tube(rest: Rest, least: float) -> None:
    """41 x 41 x 15 x 15, low, 40 s, 3 deg/s, outside the corridor, the only part that is not trivial."""
    problem = Problem(Scenario.of(3.0, 0.1), rest=rest, kind=SetKind.TUBE)
    result = HamiltonJacobi().solve(problem, Context())
    assert result.code is ResultCode.OK, result.message
    exact = reach_margin(problem.scenario, problem.points(), 40.0, rest, SetKind.TUBE) >= 0.0
    ours = result.arrays["margin_unrestricted"] >= 0.0
    assert _overlap(ours, exact, ~problem.inside()) >= least
    assert any("velocity spacing" in text for text in result.detail["warnings"])
    assert result.message


@pytest.mark.parametrize(("rest", "cells"), [(Rest.LVLH, 420), (Rest.BODY, 480)])
def test_default_grid_against_the_exact_fixed_time_set(rest: Rest, cells: int) -> None:
    problem = Problem(Scenario.of(1.0, 0.1), rest=rest)
    result = HamiltonJacobi().solve(problem, Context())
    exact = reach_margin(problem.scenario, problem.points(), 40.0, rest, SetKind.FIXED) >= 0.0
    inside = problem.inside()
    assert (exact & inside).sum() == cells
    assert result.mask is not None
    assert _overlap(result.mask, exact, inside) >= 0.97


def test_a_poisoned_boundary_is_a_numerical_failure() -> None:
    """The library's own boundary condition lets inflow run away; the default one, on the same grid, does not."""
    grid = Grid(11, 11, 150.0)
    result = run(horizon=40.0, grid=grid, boundary="extrapolate_away_from_zero")
    assert result.code is ResultCode.NUMERICAL_FAILURE
    assert result.mask is None
    assert result.margin is None
    assert "poisoned" in result.message
    assert run(horizon=40.0, grid=grid).code is ResultCode.OK


def test_a_value_that_is_not_finite_is_a_numerical_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = hamilton_jacobi._target

    def torn(*arguments: Any) -> np.ndarray:
        out = np.array(whole(*arguments))
        out[3, 3, 3, 3] = np.nan
        return out

    monkeypatch.setattr(hamilton_jacobi, "_target", torn)
    result = run()
    assert result.code is ResultCode.NUMERICAL_FAILURE
    assert result.mask is None
    assert "not finite" in result.message


def test_dismissal_stops_between_stretches() -> None:
    seen: list[float] = []
    context = Context(lambda done, _total, _message: seen.append(done), lambda: len(seen) >= 5)
    with pytest.raises(Cancelled):
        run(horizon=20.0, context=context)
    assert len(seen) == 5
    assert 0.0 < seen[-1] < 20.0


def test_one_compilation_serves_every_operating_point() -> None:
    run(3.0)
    known = list(hj_solver._programs)
    run(1.0, horizon=14.0, grid=Grid(9, 9, 30.0))
    assert list(hj_solver._programs) == known


def test_the_higher_schemes_run() -> None:
    for accuracy in ("medium", "high", "very_high"):
        result = run(2.0, horizon=4.0, accuracy=accuracy, shape=[11, 11, 7, 7], kind=SetKind.FIXED)
        assert result.code is ResultCode.OK, result.message
        assert result.detail["accuracy"] == accuracy


def test_a_narrow_box_says_so() -> None:
    result = run(domain={"x_m": 62.0, "y_m": 62.0, "v_m_s": 4.0})
    assert any("cuts the motion off" in text for text in result.detail["warnings"])


@pytest.mark.parametrize(
    "options",
    [
        {"accuracy": "extreme"},
        {"accuracy": None},
        {"boundary": "periodic"},
        {"shape": [41, 41, 15]},
        {"shape": [41, 41, 15, 4]},
        {"shape": [41, 41, 15, 102]},
        {"shape": [101, 101, 101, 101]},
        {"shape": [41.0, 41, 15, 15]},
        {"shape": [True, 41, 15, 15]},
        {"shape": "41x41x15x15"},
        {"domain": {"x_m": 100.0}},
        {"domain": {"x_m": 100.0, "y_m": 100.0, "v_m_s": -1.0}},
        {"domain": {"x_m": math.nan, "y_m": 100.0, "v_m_s": 5.0}},
        {"domain": {"x_m": 100.0, "y_m": 30.0, "v_m_s": 5.0}},
        {"domain": {"x_m": 100.0, "y_m": 100.0, "v_m_s": 0.5}},
        {"domain": [100.0, 100.0, 5.0]},
        {"acuracy": "low"},
    ],
)
def test_bad_settings_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(InvalidInput):
        run(**options)
