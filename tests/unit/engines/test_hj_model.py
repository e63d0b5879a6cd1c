"""The model of the Hamilton-Jacobi engine against CWH, and the box of states that its grid covers."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from safestart.attitude.body_frame import body_to_lvlh, lvlh_to_body, rotation
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.engines.base import Problem
from safestart.engines.hj import domain as hj_domain
from safestart.engines.hj.frame import Frame, coefficients, system_matrix
from safestart.engines.hj.settings import Settings
from safestart.engines.hj.target import TargetValues, faces, signed_distance
from safestart.errors import InvalidInput
from safestart.model.scenario import CorridorShape, Grid, Rest, Scenario, SetKind, Target

SETTINGS = Settings("low", (41, 41, 15, 15), Frame.LVLH, "fused")
GRID = Grid(21, 21, 40.0)


def rotating_gradient(target: Target, time: float) -> np.ndarray:
    """1.5 n^2 Q(2 w t), shape (2, 2), in 1/s^2: what the body frame's model drops."""
    angle, n = 2.0 * target.tumble_rate * time, target.mean_motion
    c, s = np.cos(angle), np.sin(angle)
    return 1.5 * n * n * np.array([[c, -s], [-s, -c]])


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
        settings = replace(SETTINGS, shape=(21, 21, 5, 5))
        domain = hj_domain.size_domain(problem, settings.frame)
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
        domain = hj_domain.size_domain(problem, Frame.BODY)
        np.testing.assert_allclose(domain.half[:2], self.RADIUS + 80.0)
        np.testing.assert_allclose(domain.half[2:], math.radians(3.0) * self.RADIUS + 4.0)
        assert domain.padded_for == 40.0

    @pytest.mark.parametrize("rate", [0.0, 3.0, 10.0])
    def test_lvlh_box_does_not_grow_with_the_tumble_rate(self, rate: float) -> None:
        problem = Problem(Scenario.of(rate, 0.1))
        domain = hj_domain.size_domain(problem, Frame.LVLH)
        # The gravity gradient, 3 n^2 x, adds a metre and five centimetres per second.
        assert self.RADIUS + 80.0 <= domain.half[0] <= self.RADIUS + 81.1
        assert 4.0 <= domain.half[2] <= 4.06

    @pytest.mark.parametrize("frame", list(Frame))
    @pytest.mark.parametrize("rest", list(Rest))
    def test_holds_every_start(self, rest: Rest, frame: Frame) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), rest=rest)
        domain = hj_domain.size_domain(problem, frame)
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
        settings = replace(SETTINGS, frame=frame)
        domain = hj_domain.size_domain(problem, frame)
        np.testing.assert_allclose(domain.half[0], 1.5 * self.RADIUS, rtol=0.01)
        assert any("600 s" in text for text in hj_domain.warnings(problem, domain, settings))

    def test_steps_follow_the_turning_corridor(self) -> None:
        """At the farthest start it moves by half a cell per step; a fixed-time set does not see it move."""
        problem = Problem(Scenario.of(10.0, 0.1), kind=SetKind.TUBE)
        domain = hj_domain.size_domain(problem, Frame.LVLH)
        steps, courant = hj_domain.count_steps(problem, domain, SETTINGS)
        cells = math.radians(10.0) * self.RADIUS * 40.0 / steps / domain.spacing(SETTINGS.shape)[0]
        assert 0.49 < cells <= 0.5
        assert courant < hj_domain.CFL_NUMBER
        fixed = Problem(Scenario.of(10.0, 0.1))
        assert hj_domain.count_steps(fixed, domain, SETTINGS)[1] == hj_domain.CFL_NUMBER

    def test_too_many_steps_are_refused(self) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), Grid(5, 5, 1.0), 3600.0)
        fast = hj_domain.Domain(np.array([4.0, 4.0, 500.0, 500.0]), 3600.0)
        with pytest.raises(InvalidInput, match="time steps"):
            hj_domain.count_steps(problem, fast, SETTINGS)
