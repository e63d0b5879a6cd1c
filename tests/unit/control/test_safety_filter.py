"""The filter (eq. 7) against OSQP, HiGHS and Clarabel on problems assembled here straight from the paper."""

import math

import clarabel
import numpy as np
import osqp
import pytest
from scipy.optimize import linprog
from scipy.sparse import csc_matrix

from safestart.constraints.corridor import corridor_of
from safestart.control.forecast import flight_plan
from safestart.control.gains import Gains
from safestart.control.least_violation import least_violation as least_violation_kernel
from safestart.control.safety_filter import TIE, filter_command
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.errors import InvalidInput
from safestart.model.scenario import Scenario
from safestart.optim.projection import FEASIBLE, INFEASIBLE
from safestart.optim.projection import project as project_kernel

NODES = 6
DT = 2.0


def project(normals: np.ndarray, bounds: np.ndarray, point: np.ndarray) -> int:
    return int(project_kernel(normals, bounds, point, np.empty((10, 4)), np.empty(4, np.int64)))


def least_violation(normals: np.ndarray, bounds: np.ndarray, weights: np.ndarray, point: np.ndarray) -> float:
    scratch = np.empty((10, 4)), np.empty(4, np.int64)
    return float(least_violation_kernel(normals, bounds, weights, point, *scratch))


def corridor_rows(scenario: Scenario, gains: Gains, k: int, d: int) -> tuple[np.ndarray, ...]:
    """Rows of (7) at step k in the scaled command w: matrix, drift (times the state), bounds, metres per unit."""
    corridor = corridor_of(scenario.corridor, d)
    rows, drifts, bounds, metres = [], [], [], []
    for j in range(1, NODES + 1):
        theta = scenario.target.tumble_rate * (k + j) * DT
        turn = np.eye(d)
        turn[:2, :2] = [[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]]
        n = scenario.target.mean_motion
        row = corridor.normals @ turn @ input_matrix(n, j * DT)[:d, :d] * scenario.chaser.max_acceleration
        drift = corridor.normals @ turn @ transition_matrix(n, j * DT)[:d]
        length = np.linalg.norm(row, axis=1)
        rows.append(row / length[:, None])
        drifts.append(drift / length[:, None])
        bounds.append((corridor.offsets - gains.corridor_margin) / length)
        metres.append(length / corridor.lengths)
    return np.vstack(rows), np.vstack(drifts), np.concatenate(bounds), np.concatenate(metres)


def random_state(rng: np.random.Generator, scenario: Scenario, k: int, d: int) -> np.ndarray:
    """A state near the corridor at step k, fast enough that about a third of the problems is infeasible."""
    shape = scenario.corridor
    y = math.exp(rng.uniform(math.log(0.6), math.log(150.0)))
    half = shape.x0 + shape.c_x * (y - shape.hold_radius)
    p = np.array([rng.uniform(-1.0, 1.0) * half, y, rng.uniform(-1.0, 1.0) * half if d == 3 else 0.0])
    theta = scenario.target.tumble_rate * k * DT
    turn = np.array([[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]])
    p[:2] = turn @ p[:2]
    v = rng.normal(size=3) * rng.choice([0.01, 0.3, 1.0]) * math.sqrt(scenario.chaser.max_acceleration * y)
    v[:2] += rng.choice([0.0, 1.0]) * scenario.target.tumble_rate * np.array([-p[1], p[0]])
    if d == 2:
        v[2] = 0.0
    return np.concatenate([p, v])


def largest_violation(matrix: np.ndarray, bounds: np.ndarray, weights: np.ndarray) -> float:
    """Least possible largest weighted violation over the box, by HiGHS."""
    d = matrix.shape[1]
    rows = np.hstack([matrix * weights[:, None], -np.ones((len(matrix), 1))])
    limits = [(-1.0, 1.0)] * d + [(None, None)]
    cost = np.concatenate([np.zeros(d), [1.0]])
    return float(linprog(cost, rows, weights * bounds, bounds=limits, method="highs").fun)


def by_clarabel(matrix: np.ndarray, upper: np.ndarray, centre: np.ndarray) -> np.ndarray | None:
    """Project by an interior-point solver; None when it finds the problem infeasible."""
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12
    d = len(centre)
    full = np.vstack([matrix, -np.eye(d)])
    cones = [clarabel.NonnegativeConeT(len(full))]
    limit = np.concatenate([upper, np.ones(d)])
    answer = clarabel.DefaultSolver(
        csc_matrix(np.eye(d)), -centre, csc_matrix(full), limit, cones, settings
    ).solve()
    return np.array(answer.x) if "Solved" in str(answer.status) else None


@pytest.mark.slow
def test_ten_thousand_problems_against_osqp() -> None:
    rng = np.random.default_rng(7)
    checked = infeasible = disputed = bound_active = 0
    for _ in range(100):
        d = int(rng.choice([2, 3]))
        gains = Gains(effort_weight=rng.uniform(0.0, 0.5), move_weight=rng.uniform(0.0, 2.5))
        scenario = Scenario.of(rng.choice([0.0, rng.uniform(0.1, 6.0)]), math.exp(rng.uniform(-4.5, -1.2)))
        a_max = scenario.chaser.max_acceleration
        k = int(rng.integers(0, 30))
        plan = flight_plan(scenario, gains, DT, k + 1, nodes=NODES, planar=d == 2)
        matrix, drift, bound, _ = corridor_rows(scenario, gains, k, d)
        full = np.vstack([matrix, np.eye(d)])
        lower = np.concatenate([np.full(len(matrix), -np.inf), -np.ones(d)])
        weight = 1.0 + gains.effort_weight + gains.move_weight
        solver = osqp.OSQP()
        solver.setup(
            csc_matrix(np.eye(d)), np.zeros(d), csc_matrix(full), lower, np.ones(len(full)), verbose=False,
            eps_abs=1e-9, eps_rel=1e-9, eps_prim_inf=1e-9, max_iter=4000, check_termination=10,
        )  # fmt: skip
        for _ in range(100):
            checked += 1
            x = random_state(rng, scenario, k, d)
            nominal, previous = rng.normal(size=(2, d)) * a_max
            previous /= max(1.0, np.linalg.norm(previous) / a_max)
            command, feasible = filter_command(plan, k, x, nominal, previous)
            assert np.linalg.norm(command) <= a_max * (1.0 + 1e-12)
            centre = (nominal + gains.move_weight * previous) / (weight * a_max)
            upper = np.concatenate([bound - drift @ x, np.ones(d)])
            solver.update(q=-centre, u=upper)
            result = solver.solve(raise_error=False)
            status = result.info.status_val
            if (status == 1) == feasible and status in (1, 3):
                if not feasible:
                    infeasible += 1
                    continue
                answer = np.asarray(result.x)
            else:
                # OSQP disagrees or has not converged: two other solvers decide.
                disputed += 1
                least = largest_violation(matrix, upper[: len(matrix)], np.ones(len(matrix)))
                if abs(least) <= 1e-7:
                    continue
                assert feasible == (least < 0.0)
                if not feasible:
                    infeasible += 1
                    continue
                exact = by_clarabel(full, upper, centre)
                assert exact is not None
                answer = exact
            bound_active += bool(np.abs(answer - centre).max() > 1e-6)
            answer = answer / max(1.0, float(np.linalg.norm(answer)))
            np.testing.assert_allclose(command / a_max, answer, atol=1e-6, rtol=0.0)
    assert checked == 10_000
    # The sample exercises all three outcomes: nothing active, rows active, infeasible.
    assert infeasible > 1000
    assert bound_active > 1500
    assert disputed < 500


@pytest.mark.slow
def test_infeasible_command_is_a_minimiser_by_highs() -> None:
    rng = np.random.default_rng(11)
    found = 0
    while found < 300:
        d = int(rng.choice([2, 3]))
        scenario = Scenario.of(rng.uniform(0.0, 6.0), math.exp(rng.uniform(-4.0, -1.5)))
        k = int(rng.integers(0, 30))
        x = random_state(rng, scenario, k, d)
        matrix, drift, bound, metres = corridor_rows(scenario, Gains(), k, d)
        upper = bound - drift @ x
        optimum = largest_violation(matrix, upper, metres)
        point = rng.uniform(-1.0, 1.0, d)
        value = least_violation(np.ascontiguousarray(matrix.T), upper, metres, point)
        assert value == pytest.approx(optimum, abs=1e-8, rel=1e-8)
        assert np.abs(point).max() <= 1.0
        assert (metres * (matrix @ point - upper)).max() == pytest.approx(value, abs=1e-8, rel=1e-8)
        if optimum > 0.0:
            found += 1
            # Through the filter: of the minimisers the one nearest to c, then the thrust disk.
            plan = flight_plan(scenario, Gains(), DT, k + 1, planar=d == 2)
            a_max = scenario.chaser.max_acceleration
            nominal = rng.normal(size=d) * a_max
            command, feasible = filter_command(plan, k, x, nominal, np.zeros(d))
            assert not feasible
            centre = nominal / (a_max * (1.0 + Gains().effort_weight + Gains().move_weight))
            nearest = by_clarabel(
                np.vstack([matrix, np.eye(d)]),
                np.concatenate([upper + optimum / metres + TIE, np.ones(d)]),
                centre,
            )
            assert nearest is not None
            nearest /= max(1.0, float(np.linalg.norm(nearest)))
            np.testing.assert_allclose(command / a_max, nearest, atol=1e-5)


@pytest.mark.parametrize("d", [2, 3])
def test_projection_of_special_polyhedra(d: int) -> None:
    box = np.concatenate([np.eye(d), -np.eye(d)], axis=1)
    ones = np.ones(2 * d)

    inside = np.full(d, 0.25)
    assert project(box, ones, inside) == FEASIBLE
    np.testing.assert_array_equal(inside, np.full(d, 0.25))

    corner = np.full(d, 3.0)
    assert project(box, ones, corner) == FEASIBLE
    np.testing.assert_allclose(corner, np.ones(d), atol=1e-15)

    # The same face many times, as it is when the target does not turn.
    first = np.zeros((d, 1))
    first[0] = 1.0
    same = np.concatenate([np.repeat(first, 6, axis=1), box], axis=1)
    point = np.full(d, 0.5)
    assert project(same, np.concatenate([np.linspace(-0.5, 0.5, 6), ones]), point) == FEASIBLE
    np.testing.assert_allclose(point, [-0.5, *[0.5] * (d - 1)], atol=1e-12)

    # A slab a millionth wide, and one that is empty by as much.
    slab = np.concatenate([first, -first, box], axis=1)
    point = np.full(d, 0.9)
    assert project(slab, np.concatenate([[1e-6, 0.0], ones]), point) == FEASIBLE
    assert 0.0 <= point[0] <= 1e-6 + 1e-9
    assert project(slab, np.concatenate([[-1e-6, 0.0], ones]), np.full(d, 0.9)) == INFEASIBLE


def test_projection_on_nearly_parallel_rows() -> None:
    # Faces of neighbouring nodes at a very slow tumble: the vertex is ill-defined, the projection is not.
    for angle in (1e-3, 1e-6, 1e-9, 1e-12):
        rows = np.array([[math.sin(angle), -math.sin(angle), 0.0], [math.cos(angle), math.cos(angle), -1.0]])
        point = np.array([0.3, 0.9])
        assert project(rows, np.array([0.2, 0.2, 1.0]), point) == FEASIBLE
        assert (point @ rows <= np.array([0.2, 0.2, 1.0]) + 1e-9).all()
        assert abs(point[1] - 0.2) < 1e-3
        assert abs(point[0] - 0.3) < 1e-3


def test_a_speed_limit_never_outranks_the_corridor() -> None:
    scenario = Scenario.of(1.0, 0.1)
    slow = flight_plan(scenario, Gains(speed_limit=0.01), DT, 1)
    free = flight_plan(scenario, Gains(), DT, 1)
    # Far too fast for the limit, deep inside the corridor: the limit's rows are dropped and reported.
    x = np.array([0.0, 80.0, 0.0, 0.0, -2.0, 0.0])
    command, feasible = filter_command(slow, 0, x, np.array([0.02, 0.03]), np.zeros(2))
    reference, without = filter_command(free, 0, x, np.array([0.02, 0.03]), np.zeros(2))
    assert without
    assert not feasible
    np.testing.assert_allclose(command, reference, atol=1e-12)
    # Within reach of the limit the rows hold.
    x[4] = -0.15
    command, feasible = filter_command(slow, 0, x, np.array([0.0, -0.1]), np.zeros(2))
    after = transition_matrix(1.1e-3, DT) @ x + input_matrix(1.1e-3, DT)[:, :2] @ command
    assert feasible
    assert np.abs(after[3:]).max() <= 0.01 + 1e-9


@pytest.mark.parametrize("planar", [True, False])
def test_keep_out_row(planar: bool) -> None:
    scenario = Scenario.of(0.0, 0.1)
    gains = Gains(keep_out_radius=20.0, corridor_margin=0.0)
    plan = flight_plan(scenario, gains, DT, 1, planar=planar)
    d = 2 if planar else 3
    x = np.array([3.0, 20.0, 0.0, 0.0, -0.1, 0.0])
    command, feasible = filter_command(plan, 0, x, np.full(d, -0.06), np.zeros(d))
    assert feasible
    drift = (transition_matrix(1.1e-3, DT) @ x)[:d]
    after = drift + input_matrix(1.1e-3, DT)[:d, :d] @ command
    assert drift @ after / np.linalg.norm(drift) == pytest.approx(20.0, abs=1e-9)
    # At the centre the row has no direction and is left out.
    centre, _ = filter_command(plan, 0, np.zeros(6), np.zeros(d), np.zeros(d))
    assert np.isfinite(centre).all()


def test_plan_rejects_what_it_cannot_tabulate() -> None:
    scenario = Scenario.of(1.0, 0.1)
    for arguments in ({"dt": 0.0}, {"dt": math.nan}, {"steps": 0}, {"steps": 10**9}, {"nodes": 0}):
        with pytest.raises(InvalidInput, match="required"):
            flight_plan(scenario, Gains(), **{"dt": DT, "steps": 3, **arguments})
