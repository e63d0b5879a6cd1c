"""Reach margins, containment horizons and the series behind the exact engine."""

import math
from functools import partial

import numpy as np
import pytest

from safestart.dynamics.cwh import planar_transition
from safestart.engines.exact import containment_horizon
from safestart.errors import InvalidInput
from safestart.model.scenario import Floats, Rest, Scenario, SetKind
from safestart.sets import series
from tests.unit.sets.exact_margin import reach_margin
from tests.unit.sets.support_twin import disk_support


def series_support(of: series.ReachSeries, t: float, phi: float) -> float:
    waves = np.polynomial.chebyshev.chebval(2.0 * t / of.horizon - 1.0, of.value)[4:]
    k = 2.0 * np.arange(1, len(waves) // 2 + 1)
    return float(waves[0] + waves[1::2] @ np.cos(k * phi) + waves[2::2] @ np.sin(k * phi))


class TestReachMargin:
    def test_keeps_leading_axes(self) -> None:
        assert reach_margin(Scenario.of(3.0, 0.1), np.zeros((2, 3, 2)), 40.0).shape == (2, 3)
        assert reach_margin(Scenario.of(3.0, 0.1), np.zeros((0, 2)), 40.0).shape == (0,)

    def test_distance_when_nothing_moves(self) -> None:
        """At rest, without orbit and tumble, in a moment too short to move: minus the distance to the cone."""
        scenario = Scenario.of(0.0, 1e-6, mean_motion=0.0)
        points = np.array([[0.0, -3.0], [10.0, 0.5], [-3.5, -1.5]])
        # Below the port; beside the port's edge (slope 1.5: distance 7.5 / sqrt(1 + 1.5^2)); nearest a corner.
        expected = [-3.5, -7.5 / math.hypot(1.0, 1.5), -math.hypot(1.0, 2.0)]
        found = reach_margin(scenario, points, 1e-3, kind=SetKind.FIXED)
        np.testing.assert_allclose(found, expected, atol=1e-9)

    def test_zero_tumble_zero_orbit_is_a_disk(self) -> None:
        scenario = Scenario.of(0.0, 0.1, mean_motion=0.0)
        found = reach_margin(scenario, np.array([0.0, -100.0]), 40.0, kind=SetKind.FIXED)
        assert float(found) == pytest.approx(-100.5 + 80.0, abs=1e-9)

    @pytest.mark.parametrize("points", [np.zeros((3, 3)), np.array([[math.nan, 0.0]]), np.float64(1.0)])
    def test_bad_points(self, points: Floats) -> None:
        with pytest.raises(InvalidInput, match="points"):
            containment_horizon(Scenario.of(1.0, 0.1), points)

    @pytest.mark.parametrize("horizon", [0.0, -1.0, math.inf, math.nan, 1e9])
    def test_bad_horizon(self, horizon: float) -> None:
        with pytest.raises(InvalidInput, match="bound"):
            containment_horizon(Scenario.of(1.0, 0.1), np.zeros((1, 2)), bound=horizon)


class TestContainmentHorizon:
    scenario = Scenario.of(3.0, 0.1)
    points = np.array([[0.0, 60.0], [40.0, 50.0], [-80.0, 90.0], [20.0, 20.0]])

    @pytest.mark.parametrize("rest", Rest)
    @pytest.mark.parametrize("start", [0.0, 40.0, 41.0])
    def test_first_multiple_that_holds_all(self, rest: Rest, start: float) -> None:
        found = containment_horizon(self.scenario, self.points, rest, start=start)
        wanted = next(
            t
            for t in 2.0 * np.arange(1, 301)
            if t >= start
            and (reach_margin(self.scenario, self.points, float(t), rest, SetKind.FIXED) >= 0.0).all()
        )
        assert found == wanted

    def test_none_when_out_of_reach(self) -> None:
        far = np.array([[0.0, -9000.0]])
        assert containment_horizon(Scenario.of(0.0, 0.1), far, bound=60.0) is None

    def test_no_starts(self) -> None:
        assert containment_horizon(self.scenario, np.zeros((0, 2)), start=7.0) == 8.0

    def test_bad_bounds(self) -> None:
        with pytest.raises(InvalidInput, match="dt"):
            containment_horizon(self.scenario, self.points, dt=0.0)
        with pytest.raises(InvalidInput, match="start"):
            containment_horizon(self.scenario, self.points, start=1e6)


class TestSeries:
    @pytest.mark.parametrize(
        ("n", "horizon"), [(0.0, 40.0), (1.1e-3, 40.0), (1.1e-3, 600.0), (1.3e-3, 3600.0)]
    )
    def test_against_quadrature(self, n: float, horizon: float) -> None:
        motion = partial(planar_transition, n)
        start = np.array([[0.0, -0.02], [0.02, 0.0]])
        of = series.reach_series(motion, start, horizon, 0.1)
        assert of.converged
        angles = np.linspace(0.0, np.pi, 7)
        for t in np.array([0.07, 0.5, 0.93]) * horizon:
            reference = disk_support(motion, float(t), 0.1, angles, nodes=120)
            found = [series_support(of, float(t), float(phi)) for phi in angles]
            np.testing.assert_allclose(found, reference, rtol=1e-10)
            step = motion(float(t))
            drift = np.polynomial.chebyshev.chebval(2.0 * t / horizon - 1.0, of.value)[:4].reshape(2, 2)
            np.testing.assert_allclose(drift, step[:2, :2] + step[:2, 2:] @ start, rtol=1e-11, atol=1e-11)

    def test_slope_is_the_derivative(self) -> None:
        of = series.reach_series(partial(planar_transition, 1.1e-3), np.zeros((2, 2)), 40.0, 0.1)
        h, z = 1e-3, 0.3
        ahead, behind = (np.polynomial.chebyshev.chebval(z + s * 2 * h / 40.0, of.value) for s in (1, -1))
        slope = np.polynomial.chebyshev.chebval(z, of.slope)
        np.testing.assert_allclose(slope, (ahead - behind) / (2 * h), atol=1e-9)

    def test_terms_are_few_for_one_approach(self) -> None:
        of = series.reach_series(partial(planar_transition, 1.1e-3), np.zeros((2, 2)), 40.0, 0.1)
        assert of.value.shape == (8, 11)
