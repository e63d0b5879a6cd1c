"""The Hamilton-Jacobi engine: model against CWH, value bounds, the exact set, failure, cancellation, bad input."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from safestart.attitude.body_frame import body_to_lvlh, lvlh_to_body, rotation
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.engines.exact import reach_margin
from safestart.engines.hamilton_jacobi import HamiltonJacobi
from safestart.engines.hj import domain as hj_domain
from safestart.engines.hj import peer
from safestart.engines.hj.frame import Frame, coefficients, system_matrix
from safestart.engines.hj.settings import Settings
from safestart.engines.hj.target import TargetValues, faces, signed_distance
from safestart.errors import Cancelled, InvalidInput
from safestart.model.scenario import CorridorShape, Grid, Rest, Scenario, SetKind, Target
from safestart.runtime.progress import Context

SMALL = [21, 21, 9, 9]
GRID = Grid(21, 21, 40.0)


def rotating_gradient(target: Target, time: float) -> np.ndarray:
    """1.5 n^2 Q(2 w t), shape (2, 2), in 1/s^2: what the body frame's model drops."""
    angle, n = 2.0 * target.tumble_rate * time, target.mean_motion
    c, s = np.cos(angle), np.sin(angle)
    return 1.5 * n * n * np.array([[c, -s], [-s, -c]])


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
        matrix = system_matrix(target, Frame.BODY)

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

    @pytest.mark.parametrize("rate", [0.0, 3.0])
    def test_in_lvlh_it_is_cwh_as_it_is(self, rate: float) -> None:
        target = Scenario.of(rate, 0.1).target
        matrix, n = system_matrix(target, Frame.LVLH), target.mean_motion
        start = np.concatenate(self.START)
        drive = np.concatenate([np.zeros(2), self.THRUST])
        flown = _rk4(lambda _, state: matrix @ state + drive, start, 40.0, 400)
        expected = planar_transition(n, 40.0) @ start + planar_input(n, 40.0) @ self.THRUST
        np.testing.assert_allclose(flown, expected, rtol=0, atol=1e-9)

    @pytest.mark.parametrize("frame", list(Frame))
    def test_no_orbit_no_tumble_is_a_double_integrator(self, frame: Frame) -> None:
        assert coefficients(Target(0.0, 0.0), frame) == (0.0, 0.0, 0.0)

    def test_signed_distance(self) -> None:
        shape = CorridorShape()
        points = np.array([[0.0, 0.5], [0.0, 10.0], [0.0, -3.0], [2.5 + 1.5 * 9.5, 10.0], [100.0, 10.0]])
        root = math.hypot(1.0, 1.5)
        side = (2.5 + 1.5 * 9.5) / root
        expected = [0.0, -min(9.5, side), 3.5, 0.0, (100.0 - 1.5 * 9.5 - 2.5) / root]
        np.testing.assert_allclose(signed_distance(shape, points), expected, atol=1e-12)
        rows = np.column_stack([points, np.ones(len(points))]) @ faces(shape).T
        np.testing.assert_allclose(rows.max(axis=1), expected, atol=1e-12)

    @pytest.mark.parametrize("rate", [0.0, 3.0])
    def test_turned_target(self, rate: float) -> None:
        """At the horizon l at a body-fixed point is what it was at t = 0; a tube's range holds every angle."""
        problem = Problem(Scenario.of(rate, 0.1), GRID, kind=SetKind.TUBE)
        settings = Settings(shape=(21, 21, 5, 5))
        domain = hj_domain.size_domain(problem, settings)
        x, y, _, _ = domain.axes(settings.shape)
        values = TargetValues.of(problem, domain, settings)
        lvlh = np.array([x[4], y[17]])
        body, _ = lvlh_to_body(lvlh, np.zeros(2), problem.scenario.target.tumble_rate, problem.horizon)
        shape = problem.scenario.corridor
        np.testing.assert_allclose(values.terminal[4, 17, 2, 3], signed_distance(shape, body), atol=1e-12)
        np.testing.assert_allclose(values.first[4, 17, 2, 3], signed_distance(shape, lvlh), atol=1e-12)
        nodes = np.stack(np.meshgrid(x, y), axis=-1)
        angles = np.linspace(0.0, math.radians(rate) * problem.horizon, 200)
        least = min(signed_distance(shape, nodes @ rotation(angle)).min() for angle in angles)
        assert values.low <= least + 1e-9
        assert values.low >= least - 10.0


class TestDomain:
    RADIUS = math.hypot(2.5 + 1.5 * 149.5, 150.0)

    @pytest.mark.parametrize("rest", list(Rest))
    def test_body_frame(self, rest: Rest) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), rest=rest)
        domain = hj_domain.size_domain(problem, Settings(frame=Frame.BODY))
        np.testing.assert_allclose(domain.half[:2], self.RADIUS + 80.0)
        np.testing.assert_allclose(domain.half[2:], math.radians(3.0) * self.RADIUS + 4.0)
        assert domain.padded_for == 40.0

    @pytest.mark.parametrize("rate", [0.0, 3.0, 10.0])
    def test_lvlh_box_does_not_grow_with_the_tumble_rate(self, rate: float) -> None:
        problem = Problem(Scenario.of(rate, 0.1))
        domain = hj_domain.size_domain(problem, Settings())
        # The gravity gradient, 3 n^2 x, adds a metre and five centimetres per second.
        assert self.RADIUS + 80.0 <= domain.half[0] <= self.RADIUS + 81.1
        assert 4.0 <= domain.half[2] <= 4.06

    @pytest.mark.parametrize("frame", list(Frame))
    @pytest.mark.parametrize("rest", list(Rest))
    def test_holds_every_start(self, rest: Rest, frame: Frame) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), rest=rest)
        domain = hj_domain.size_domain(problem, Settings(frame=frame))
        states = np.abs(hj_domain.start_states(problem, frame)).reshape(-1, 4).max(axis=0)
        assert (states <= domain.half).all()

    @pytest.mark.parametrize("rest", list(Rest))
    def test_starts_are_the_same_in_both_frames(self, rest: Rest) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), GRID, rest=rest)
        body, lvlh = (hj_domain.start_states(problem, frame) for frame in (Frame.BODY, Frame.LVLH))
        p, v = body_to_lvlh(body[..., :2], body[..., 2:], problem.scenario.target.tumble_rate, 0.0)
        np.testing.assert_allclose(np.concatenate([p, v], axis=-1), lvlh, atol=1e-12)
        at_rest = body if rest is Rest.BODY else lvlh
        np.testing.assert_array_equal(at_rest[..., 2:], 0.0)

    @pytest.mark.parametrize("frame", list(Frame))
    def test_long_horizons_do_not_widen_it_for_ever(self, frame: Frame) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), horizon=600.0)
        settings = Settings(frame=frame)
        domain = hj_domain.size_domain(problem, settings)
        np.testing.assert_allclose(domain.half[0], 1.5 * self.RADIUS, rtol=0.01)
        assert any("600 s" in text for text in hj_domain.warnings(problem, domain, settings))

    def test_steps_follow_the_turning_corridor(self) -> None:
        """At the farthest start it moves by half a cell per step; a fixed-time set does not see it move."""
        problem = Problem(Scenario.of(10.0, 0.1), kind=SetKind.TUBE)
        domain = hj_domain.size_domain(problem, Settings())
        steps, courant = hj_domain.count_steps(problem, domain, Settings())
        cells = math.radians(10.0) * self.RADIUS * 40.0 / steps / domain.spacing(Settings().shape)[0]
        assert 0.49 < cells <= 0.5
        assert courant < hj_domain.CFL_NUMBER
        fixed = Problem(Scenario.of(10.0, 0.1))
        assert hj_domain.count_steps(fixed, domain, Settings())[1] == hj_domain.CFL_NUMBER

    def test_too_many_steps_are_refused(self) -> None:
        with pytest.raises(InvalidInput, match="time steps"):
            run(horizon=3600.0, grid=Grid(5, 5, 1.0), domain={"x_m": 4.0, "y_m": 4.0, "v_m_s": 500.0})


@pytest.mark.parametrize("frame", list(Frame))
@pytest.mark.parametrize(("rest", "rate"), [(Rest.LVLH, 0.0), (Rest.LVLH, 3.0), (Rest.BODY, 3.0)])
def test_bounds_and_inclusions(rest: Rest, rate: float, frame: Frame) -> None:
    """V in l's range, a tube that grows with the horizon, the fixed-time set in it, all inside the corridor."""
    tube = run(rate, 12.0, rest=rest, frame=frame.value)
    fixed = run(rate, 12.0, rest=rest, kind=SetKind.FIXED, frame=frame.value)
    inside = Problem(Scenario.of(rate, 0.1), GRID).inside()
    for result in (tube, fixed):
        assert result.code is ResultCode.OK, result.message
        assert result.detail["frame"] == frame.value
        assert result.mask is not None
        assert not (result.mask & ~inside).any()
        detail = result.detail
        spread = detail["target_max_m"] - detail["target_min_m"]
        assert detail["value_min_m"] >= detail["target_min_m"] - 1e-3 * spread
        assert detail["value_max_m"] <= detail["target_max_m"] + 1e-3 * spread
    np.testing.assert_array_equal(tube.mask, inside, err_msg="a tube contains its target")
    # The automatic box grows with the horizon; one box for all makes the values comparable.
    box = {"x_m": 90.0, "y_m": 90.0, "v_m_s": 6.0}
    short, long = (
        run(rate, horizon, rest=rest, domain=box, frame=frame.value).arrays["margin_unrestricted"]
        for horizon in (6.0, 12.0)
    )
    end = run(rate, 12.0, rest=rest, kind=SetKind.FIXED, domain=box, frame=frame.value)
    at_end = end.arrays["margin_unrestricted"]
    assert (long >= short - 1e-3).all()
    assert (long >= at_end - 1e-3).all()
    assert (long > short + 0.1).any()


def _overlap(a: np.ndarray, b: np.ndarray, where: np.ndarray) -> float:
    return float((a & b & where).sum() / (a | b)[where].sum())


def test_frames_agree_where_nothing_turns() -> None:
    for kind in SetKind:
        body, lvlh = (run(0.0, 12.0, kind=kind, frame=frame.value) for frame in Frame)
        gap = np.abs(body.arrays["margin_unrestricted"] - lvlh.arrays["margin_unrestricted"]).max()
        assert gap < 0.05


def test_auto_is_lvlh_but_for_corotating_tubes() -> None:
    for rest in Rest:
        for kind in SetKind:
            frame = "body" if (rest, kind) == (Rest.BODY, SetKind.TUBE) else "lvlh"
            detail = run(horizon=2.0, rest=rest, kind=kind).detail
            assert detail["frame"] == frame
            assert ("nothing dropped" in detail["model"]) is (frame == "lvlh")


def against_exact(
    rate: float, kind: SetKind, rest: Rest = Rest.LVLH, **options: Any
) -> tuple[float, int, EngineResult]:
    """IoU, exact cells and result: 41 x 41 x 15 x 15, 40 s; fixed-time sets in the corridor, tubes outside it."""
    problem = Problem(Scenario.of(rate, 0.1), rest=rest, kind=kind, options={"hamilton_jacobi": options})
    result = HamiltonJacobi().solve(problem, Context())
    assert result.code is ResultCode.OK, result.message
    exact = reach_margin(problem.scenario, problem.points(), 40.0, rest, kind) >= 0.0
    where = problem.inside() if kind is SetKind.FIXED else ~problem.inside()
    ours = result.arrays["margin_unrestricted"] >= 0.0
    return _overlap(ours, exact, where), int((exact & where).sum()), result


@pytest.mark.parametrize(("rate", "cells", "least"), [(1.0, 420, 0.98), (3.0, 237, 0.87), (5.0, 97, 0.65)])
def test_default_grid_against_the_exact_fixed_time_set(rate: float, cells: int, least: float) -> None:
    overlap, exact, result = against_exact(rate, SetKind.FIXED)
    assert exact == cells
    assert overlap >= least
    # The scheme is what is left to complain of: velocity axes and box are fine at every rate.
    (warning,) = result.detail["warnings"]
    assert "take a higher accuracy" in warning


def test_a_sharper_scheme_repairs_most_of_it() -> None:
    overlap, _, result = against_exact(3.0, SetKind.FIXED, accuracy="very_high")
    assert overlap >= 0.97
    assert not result.detail["warnings"]


@pytest.mark.parametrize(("rate", "least"), [(1.0, 0.97), (3.0, 0.945), (5.0, 0.96)])
def test_default_grid_against_the_exact_tube(rate: float, least: float) -> None:
    assert against_exact(rate, SetKind.TUBE)[0] >= least


@pytest.mark.parametrize(("kind", "rate", "least"), [(SetKind.FIXED, 1.0, 0.99), (SetKind.TUBE, 3.0, 0.83)])
def test_rest_in_the_body_against_the_exact_sets(kind: SetKind, rate: float, least: float) -> None:
    assert against_exact(rate, kind, Rest.BODY)[0] >= least


def test_the_frame_of_the_paper_says_where_it_fails() -> None:
    """At 3 deg/s its velocity axes hold 18 m/s, where thrust brings about 4: half of the set is lost."""
    overlap, _, result = against_exact(3.0, SetKind.FIXED, frame="body", shape=[31, 31, 15, 15])
    assert overlap < 0.6
    assert any("velocity spacing" in text for text in result.detail["warnings"])
    assert result.message


def test_every_result_carries_its_measured_error() -> None:
    """False-safe and false-unsafe cells by support functions; in the paper's frame at 5 deg/s most are wrong."""
    problem = Problem(
        Scenario.of(5.0, 0.1),
        rest=Rest.BODY,
        options={"hamilton_jacobi": {"frame": "body", "accuracy": "low"}},
    )
    result = HamiltonJacobi().solve(problem, Context())
    margin = reach_margin(problem.scenario, problem.points(), 40.0, Rest.BODY, SetKind.FIXED)
    np.testing.assert_allclose(result.arrays["margin_exact"], margin, atol=1e-9)
    ours = result.arrays["margin_unrestricted"] >= 0.0
    for name, where in (("grid", np.ones_like(ours)), ("in_corridor", problem.inside())):
        counted = result.detail["certified"][name]
        assert counted["false_safe"] == int((ours & (margin < -1e-6) & where).sum())
        assert counted["false_unsafe"] == int((~ours & (margin > 1e-6) & where).sum())
        assert counted["inner"] <= counted["outer"] <= counted["inner"] + 2
    assert result.detail["certified"]["in_corridor"]["false_safe"] > 50
    better = replace(problem, options={"hamilton_jacobi": {"accuracy": "very_high"}})
    counted = HamiltonJacobi().solve(better, Context()).detail["certified"]["in_corridor"]
    assert counted["false_safe"] <= 4


def test_a_velocity_aware_set_is_held_against_the_outer_bound_only() -> None:
    counted = run(match=0.5, kind=SetKind.FIXED).detail["certified"]["grid"]
    assert counted["inner"] is None
    assert counted["false_unsafe"] is None
    assert counted["false_safe"] == 0


def test_in_double_precision_the_answer_is_the_same() -> None:
    single, double = (run(precision=name, accuracy="high") for name in ("float32", "float64"))
    assert double.detail["precision"] == "float64"
    gap = single.arrays["margin_unrestricted"] - double.arrays["margin_unrestricted"]
    assert 0.0 < np.abs(gap).max() < 1e-3


def test_a_poisoned_boundary_is_a_numerical_failure() -> None:
    """The library's own boundary condition lets inflow run away; the default one, on the same grid, does not."""
    grid = Grid(11, 11, 150.0)
    result = run(horizon=40.0, grid=grid, boundary="extrapolate_away_from_zero", frame="body")
    assert result.code is ResultCode.NUMERICAL_FAILURE
    assert result.mask is None
    assert result.margin is None
    assert "poisoned" in result.message
    assert run(horizon=40.0, grid=grid, frame="body").code is ResultCode.OK


def test_a_value_that_is_not_finite_is_a_numerical_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = TargetValues.of

    def torn(*arguments: Any) -> TargetValues:
        values = whole(*arguments)
        terminal = np.array(values.terminal)
        terminal[3, 3, 3, 3] = np.nan
        return replace(values, terminal=terminal)

    monkeypatch.setattr(TargetValues, "of", torn)
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
    run(3.0, solver="hj_reachability")
    known = list(peer._programs)
    run(1.0, horizon=14.0, grid=Grid(9, 9, 30.0), solver="hj_reachability")
    assert list(peer._programs) == known


def test_a_fixed_time_set_is_one_program_in_both_frames() -> None:
    run(3.0, kind=SetKind.FIXED, solver="hj_reachability")
    known = list(peer._programs)
    run(3.0, kind=SetKind.FIXED, frame="body", solver="hj_reachability")
    assert list(peer._programs) == known


def test_the_higher_schemes_run() -> None:
    for accuracy in ("medium", "high"):
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
        {"domain": {"x_m": 100.0, "y_m": 100.0, "v_m_s": 0.5}, "frame": "body"},
        {"frame": "eci"},
        {"frame": "LVLH"},
        {"frame": None},
        {"frame": ["lvlh"]},
        {"solver": "jax"},
        {"precision": "float16"},
        {"precision": "float64", "solver": "hj_reachability"},
        {"domain": [100.0, 100.0, 5.0]},
        {"acuracy": "low"},
    ],
)
def test_bad_settings_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(InvalidInput):
        run(**options)
