"""The exact engine against its NumPy twin, flown trajectories and an independent convex solver."""

import math
from itertools import pairwise

import clarabel
import numpy as np
import pytest
from scipy import sparse

from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import planar_input, planar_transition
from safestart.engines.backward import Backward
from safestart.engines.base import Engine, Problem, ResultCode
from safestart.engines.exact import Exact, reach_of
from safestart.engines.forward import Forward
from safestart.engines.region import restrict
from safestart.model.scenario import Chaser, CorridorShape, Floats, Grid, Rest, Scenario, SetKind, Target
from safestart.runtime.progress import Context
from safestart.sets import series
from tests.unit.engines import exact_twin
from tests.unit.sets.exact_margin import reach_margin

NARROW = CorridorShape(c_x=0.3, x0=0.0, hold_radius=3.0)
CASES = {
    "paper, 1 deg/s": (Scenario.of(1.0, 0.1), 40.0, 220.0),
    "paper, 5 deg/s": (Scenario.of(5.0, 0.1), 40.0, 220.0),
    "more than two turns": (Scenario.of(20.0, 0.05), 40.0, 60.0),
    "no tumble": (Scenario.of(0.0, 0.02), 30.0, 60.0),
    "no orbit": (Scenario.of(3.0, 0.1, mean_motion=0.0), 40.0, 150.0),
    "narrow corridor": (Scenario(Target(math.radians(2.0)), Chaser(0.05), NARROW), 60.0, 120.0),
    "long horizon": (Scenario.of(0.05, 0.01, mean_motion=1.3e-3), 900.0, 4000.0),
}


def some_points(extent: float, count: int = 16, seed: int = 1) -> Floats:
    return np.random.default_rng(seed).uniform(-extent, extent, (count, 2))


@pytest.mark.parametrize("rest", Rest)
@pytest.mark.parametrize("case", CASES)
class TestTwin:
    def test_tube_and_fixed_margins(self, case: str, rest: Rest) -> None:
        scenario, horizon, extent = CASES[case]
        points = some_points(extent)
        for kind in SetKind:
            ours = reach_margin(scenario, points, horizon, rest, kind)
            twin = exact_twin.margin(scenario, points, horizon, rest, kind)
            np.testing.assert_allclose(ours, twin, atol=2e-4, rtol=0)
            np.testing.assert_array_equal(ours >= 0.0, twin >= 0.0)


# A corridor that turned once has met every start, so its tube has no boundary.
BOUNDED = [
    name
    for name, (scenario, horizon, _) in CASES.items()
    if scenario.target.tumble_rate * horizon < 2.0 * math.pi
]


@pytest.mark.parametrize("rest", list(Rest))
@pytest.mark.parametrize("case", BOUNDED)
def test_boundary_is_within_a_micrometre_of_the_twins(case: str, rest: Rest) -> None:
    scenario, horizon, extent = CASES[case]
    inner, outer = boundary(scenario, horizon, rest, extent)
    assert len(inner) >= 1
    found = exact_twin.margin(scenario, 0.5 * (inner + outer), horizon, rest, SetKind.TUBE, rounds=10)
    assert np.abs(found).max() <= 1e-6


def boundary(scenario: Scenario, horizon: float, rest: Rest, extent: float) -> tuple[Floats, Floats]:
    """Pairs of points, 1e-9 m apart, that the engine puts inside and outside the tube."""
    inner = np.tile([0.0, scenario.corridor.hold_radius + 1.0], (12, 1))
    angle = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False) + 0.3
    outer = inner + 2.0 * extent * np.stack([np.cos(angle), np.sin(angle)], -1)
    keep = reach_margin(scenario, outer, horizon, rest) < 0.0
    inner, outer = inner[keep], outer[keep]
    while np.abs(outer - inner).max() > 1e-9:
        middle = 0.5 * (inner + outer)
        inside = (reach_margin(scenario, middle, horizon, rest) >= 0.0)[:, None]
        inner, outer = np.where(inside, middle, inner), np.where(inside, outer, middle)
    return inner, outer


@pytest.mark.parametrize("rest", Rest)
def test_flight_under_the_maximising_thrust_reaches_the_support(rest: Rest) -> None:
    """RK4 through the CWH equations, thrust a_max Phi_rv(T - t)^T e / |.|: the margin's witness."""
    scenario, horizon, n = Scenario.of(3.0, 0.1, mean_motion=1.3e-3), 40.0, 1.3e-3
    omega = scenario.target.tumble_rate
    model = reach_of(scenario, horizon, rest)
    p = np.array([-40.0, -60.0])
    velocity = omega * np.array([-p[1], p[0]]) if rest is Rest.BODY else np.zeros(2)
    theta = omega * horizon
    turn = np.array([[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]])
    margin = float(model.at(p[None], horizon)[0])
    best = math.inf
    for a in (-model.arc.half_angle, -0.2, 0.0, model.arc.half_angle):
        d = np.array([math.sin(a), math.cos(a)])
        e = turn.T @ d

        def rate(t: float, x: Floats, e: Floats = e) -> Floats:
            w = planar_transition(n, horizon - t)[:2, 2:].T @ e
            u = 0.1 * w / np.hypot(*w) if t < horizon else 0.1 * e
            gravity = np.array([3 * n * n * x[0] + 2 * n * x[3], -2 * n * x[2]])
            return np.concatenate([x[2:], gravity + u])

        x, steps = np.concatenate([p, velocity]), 400
        h = horizon / steps
        for k in range(steps):
            k1 = rate(k * h, x)
            k2 = rate((k + 0.5) * h, x + 0.5 * h * k1)
            k3 = rate((k + 0.5) * h, x + 0.5 * h * k2)
            k4 = rate((k + 1) * h, x + h * k3)
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        q = exact_twin.drift(scenario, rest, p, np.array(horizon))
        support = series_support(model.series, horizon, math.atan2(e[1], e[0]))
        assert abs(d @ (turn @ x[:2]) - (d @ np.array(q) + support)) < 1e-9
        best = min(best, float(d @ (turn @ x[:2])) + 2.5 * abs(d[0]) - 0.5 * d[1])
    assert margin <= best + 1e-9


def series_support(of: series.ReachSeries, t: float, phi: float) -> float:
    waves = np.polynomial.chebyshev.chebval(2.0 * t / of.horizon - 1.0, of.value)[4:]
    k = 2.0 * np.arange(1, len(waves) // 2 + 1)
    return float(waves[0] + waves[1::2] @ np.cos(k * phi) + waves[2::2] @ np.sin(k * phi))


def conic_distance(scenario: Scenario, p: Floats, horizon: float, dt: float) -> float:
    """Distance from the zero-order-hold disk-input reachable set to the corridor: an SOCP for Clarabel."""
    n, count = scenario.target.mean_motion, round(horizon / dt)
    a, b = planar_transition(n, dt), planar_input(n, dt)
    theta = scenario.target.tumble_rate * horizon
    turn = np.array([[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]])
    gains = [turn @ (np.linalg.matrix_power(a, count - 1 - k) @ b)[:2] for k in range(count)]
    drift = turn @ np.linalg.matrix_power(a, count)[:2, :2] @ p
    corridor = corridor_of(scenario.corridor)
    # Variables: r, the target point c (2), the inputs in units of a_max (2 count).
    size = 3 + 2 * count
    normals = np.zeros((len(corridor.offsets), size))
    normals[:, 1:3] = corridor.normals
    gap = np.zeros((3, size))
    gap[0, 0] = -1.0
    gap[1:, 1:3] = np.eye(2)
    gap[1:, 3:] = -scenario.chaser.max_acceleration * np.hstack(gains)
    disks = np.zeros((3 * count, size))
    for k in range(count):
        disks[3 * k + 1, 3 + 2 * k] = disks[3 * k + 2, 4 + 2 * k] = -1.0
    rows = sparse.csc_matrix(np.vstack([normals, gap, disks]))
    # Rows `gap` hold (r, drift + G u - c) in the second-order cone: Clarabel keeps bound - rows x in it.
    bound = np.concatenate([corridor.offsets, [0.0], drift, np.tile([1.0, 0.0, 0.0], count)])
    cones = [clarabel.NonnegativeConeT(len(corridor.offsets))]
    cones += [clarabel.SecondOrderConeT(3) for _ in range(1 + count)]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-11
    cost = np.zeros(size)
    cost[0] = 1.0
    zero = sparse.csc_matrix((size, size))
    solution = clarabel.DefaultSolver(zero, cost, rows, bound, cones, settings).solve()
    return float(solution.x[0])


class TestIndependentSolver:
    """Clarabel on the zero-order-hold problem: an inner set that converges to the exact one."""

    scenario = Scenario.of(0.0, 0.01, mean_motion=1.3e-3)
    horizon = 600.0

    @pytest.mark.parametrize("p", [(3000.0, -9000.0), (-9000.0, -7000.0), (100.0, -9000.0)])
    def test_second_order_from_inside(self, p: tuple[float, float]) -> None:
        start = np.array(p)
        distance = -float(reach_margin(self.scenario, start, self.horizon, Rest.LVLH, SetKind.FIXED))
        assert distance > 0.0
        errors = [
            conic_distance(self.scenario, start, self.horizon, dt) - distance for dt in (150.0, 75.0, 37.5)
        ]
        assert all(error > 0.0 for error in errors), "a held input cannot reach farther than a free one"
        for coarse, fine in pairwise(errors):
            assert 1.8 < math.log2(coarse / fine) < 2.2
        assert errors[-1] < 0.5

    def test_two_second_holds_agree_at_the_operating_point(self) -> None:
        scenario = Scenario.of(3.0, 0.1)
        for start in some_points(150.0, 12, seed=5):
            margin = float(reach_margin(scenario, start, 40.0, Rest.LVLH, SetKind.FIXED))
            if margin < 0.0:
                distance = conic_distance(scenario, start, 40.0, 2.0)
                assert -1e-7 <= distance + margin < 1e-4


class TestEngine:
    problem = Problem(Scenario.of(3.0, 0.1), kind=SetKind.TUBE)

    def test_a_tube_cut_to_the_corridor_is_the_corridor(self) -> None:
        result = Exact().solve(self.problem, Context())
        np.testing.assert_array_equal(result.mask, self.problem.inside())
        free = result.arrays["margin_unrestricted"]
        assert (free[~self.problem.inside()] >= 0.0).sum() > 200
        assert (free[self.problem.inside()] >= -1e-9).all()
        assert ((result.arrays["reach_time"] >= 0.0) & (result.arrays["reach_time"] <= 40.0)).all()

    @pytest.mark.parametrize("engine", [Exact, Backward, Forward])
    @pytest.mark.parametrize("ny", [31, 40, 101])
    def test_starts_on_the_corridors_edge_belong_to_the_tube(self, engine: type[Engine], ny: int) -> None:
        """At rest in the body frame and thrown outwards: t = 0 is their only moment in the corridor."""
        shape = CorridorShape(c_x=0.7, x0=0.3, hold_radius=0.1)
        scenario = Scenario(Target(math.radians(20.0)), Chaser(0.01), shape)
        problem = Problem(scenario, Grid(31, ny, 60.0), 0.6, 0.2, Rest.BODY, SetKind.TUBE)
        np.testing.assert_array_equal(engine().solve(problem, Context()).mask, problem.inside())

    def test_restriction_forgives_round_off_only(self) -> None:
        problem = Problem(Scenario.of(3.0, 0.1), Grid(5, 5))
        inside = problem.inside()
        for reach, belongs in [(1.0, True), (0.0, True), (-1e-12, True), (-1e-6, False)]:
            mask, margin = restrict(problem, np.full(inside.shape, reach))
            np.testing.assert_array_equal(mask, inside & belongs)
            np.testing.assert_array_equal(margin >= 0.0, mask)

    @pytest.mark.parametrize("rest", Rest)
    @pytest.mark.parametrize("rate", [0.0, 1.0, 5.0])
    def test_fixed_inside_tube_and_tubes_grow(self, rate: float, rest: Rest) -> None:
        scenario = Scenario.of(rate, 0.1)
        points = Grid(15, 15, 200.0).points(scenario.corridor) - [0.0, 60.0]
        before = np.full(points.shape[:-1], -np.inf)
        for horizon in (4.0, 11.0, 23.0, 40.0):
            tube = reach_margin(scenario, points, horizon, rest)
            fixed = reach_margin(scenario, points, horizon, rest, SetKind.FIXED)
            # Away from zero margins are good to 1e-4 m; the sign must not flip at all.
            assert (tube >= np.maximum(before, fixed) - 1e-4).all()
            assert not ((np.maximum(before, fixed) >= 0.0) & (tube < -1e-9)).any()
            before = tube

    def test_time_of_the_best_margin(self) -> None:
        result = Exact().solve(self.problem, Context())
        when = result.arrays["reach_time"]
        for i, j in [(0, 0), (3, 14), (12, 2), (30, 30)]:
            start = self.problem.points()[i, j]
            if when[i, j] > 0.0:
                fixed = reach_margin(
                    self.problem.scenario, start, float(when[i, j]), self.problem.rest, SetKind.FIXED
                )
                assert float(fixed) == pytest.approx(result.arrays["margin_unrestricted"][i, j], abs=1e-8)

    def test_chunks_do_not_change_the_answer(self, monkeypatch: pytest.MonkeyPatch) -> None:
        whole = Exact().solve(self.problem, Context())
        monkeypatch.setattr("safestart.engines.exact.CHUNK", 100)
        seen: list[float] = []
        parts = Exact().solve(self.problem, Context(lambda done, total, _: seen.append(done / total)))
        np.testing.assert_array_equal(whole.margin, parts.margin)
        assert len(seen) == 10
        assert seen[-1] == 1.0

    def test_compilation_is_counted_once(self) -> None:
        Exact().solve(self.problem, Context())
        assert Exact().solve(self.problem, Context()).compile_s == 0.0

    @pytest.mark.parametrize("kind", SetKind)
    def test_series_that_does_not_converge_is_a_result_code(
        self, kind: SetKind, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(series, "CONVERGED", 0.0)
        monkeypatch.setattr(series, "MAX_DEGREE", 16)
        result = Exact().solve(Problem(Scenario.of(3.0, 0.1), kind=kind), Context())
        assert result.code is ResultCode.NUMERICAL_FAILURE
        assert result.mask is None
        assert result.margin is None
        assert "not finite" in result.message
