"""The tracking MPC: its equilibria, its tail controllers, its programs, and paper 002's flight."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from safestart.control.tracking_mpc import equilibrium
from safestart.control.tracking_mpc.controller import Program, TrackingMpc
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.step_kernel import INFEASIBLE, SOLVED, solve_from
from safestart.control.tracking_mpc.theta_set import theta_set
from safestart.control.tracking_mpc.tuning import DockingCorridor, Tuning
from safestart.errors import InvalidInput
from tests.unit.tracking.envisat import MEAN_MOTION, SHAPE, START, envisat, program


@pytest.mark.parametrize("period", [0.1, 1.0, 5.0])
def test_an_equilibrium_is_a_trajectory(period):
    motion = Sampled(MEAN_MOTION, period)
    attitudes = Rotation.random(40, random_state=3).as_matrix()
    theta = np.array([0.3, 0.7, -0.2])
    states = equilibrium.states(motion, attitudes) @ theta
    inputs = equilibrium.inputs(motion, attitudes) @ theta
    for k, given in enumerate(inputs):
        after = motion.a @ states[k]
        after[3:] += attitudes[k].T @ given
        scale = max(1.0, 1.0 / period)
        np.testing.assert_allclose(after[:3], states[k + 1][:3], atol=1e-13 * scale)
        np.testing.assert_allclose(after[3:], states[k + 1][3:], atol=1e-13 * scale)
        np.testing.assert_allclose(attitudes[k] @ states[k, :3], theta, atol=1e-14)


def test_the_papers_kernel_is_no_trajectory():
    """M(k) = ker [A(k) - I, B(k)] assumes v_e(k + 1) = v_e(k): the residual is what our inputs differ by."""
    motion, attitudes = Sampled(MEAN_MOTION, 1.0), envisat().nodes(1.0, 4)
    velocity = equilibrium.states(motion, attitudes)[:, 3:]
    assert np.abs(velocity[1] - velocity[0]).max() > 5e-3


@pytest.mark.parametrize("period", [0.5, 1.0, 2.0, 20.0])
def test_two_dead_beat_inputs_end_any_deviation(period):
    motion = Sampled(MEAN_MOTION, period)
    closed = motion.a + np.vstack([np.zeros((3, 6)), motion.dead_beat()])
    assert np.abs(closed @ closed).max() <= 1e-12 * max(1.0, period)
    rr, rv, vr, vv = motion.a[:3, :3], motion.a[:3, 3:], motion.a[3:, :3], motion.a[3:, 3:]
    printed = np.hstack([-motion.p @ (rr @ rr + rv @ vr), -(rr @ rv + rv @ vv)])
    wrong = motion.a + np.vstack([np.zeros((3, 6)), printed])
    assert np.abs(wrong @ wrong).max() > 1e-4


@pytest.mark.parametrize(
    ("rho", "tau", "within_5cm", "within_1cm", "impulse"),
    [(1.0, 1.0, 35, 47, 0.747), (1.0, 100.0, 11, 12, 1.269), (100.0, 100.0, 22, 26, 0.918)],
)
def test_the_papers_flight(rho, tau, within_5cm, within_1cm, impulse):
    mpc, attitudes = program(Tuning(rho=rho, tau=tau, theta_limit="printed"))
    state, ranges, total, costs = START.copy(), [], 0.0, []
    for k in range(60):
        plan = mpc.plan(attitudes[k:], state)
        assert plan.feasible
        costs.append(plan.cost)
        total += float(np.linalg.norm(plan.inputs[0]))
        np.testing.assert_allclose(plan.states[1][:3], (mpc.motion.a @ state)[:3], atol=1e-14)
        state = plan.states[1].copy()
        ranges.append(float(np.linalg.norm(state[:3])))
    outside = np.array(ranges)
    assert 1 + int(np.nonzero(outside >= 0.05)[0].max()) + 1 == within_5cm
    assert 1 + int(np.nonzero(outside >= 0.01)[0].max()) + 1 == within_1cm
    assert round(total, 3) == impulse
    assert (np.diff(costs) < 1e-9).all()


def test_a_plan_is_its_own_prediction():
    mpc, attitudes = program()
    plan = mpc.plan(attitudes, START)
    total = mpc.tuning.inputs
    body = np.einsum("kij,kj->ki", attitudes[: total + 1], plan.states[:, :3])
    assert mpc.faces.slack(body[1:]).min() >= -1e-10
    assert np.abs(plan.inputs).max() <= mpc.tuning.u_max + 1e-12
    np.testing.assert_allclose(body[-1], plan.theta, atol=1e-10)
    targets = equilibrium.states(mpc.motion, attitudes[: total + 2]) @ plan.theta
    held = equilibrium.inputs(mpc.motion, attitudes[: total + 2]) @ plan.theta
    cost = ((plan.states[:-1] - targets[:-1]) ** 2).sum() + 100.0 * ((plan.inputs - held) ** 2).sum()
    assert plan.cost == pytest.approx(cost + 100.0 * plan.theta @ plan.theta, rel=1e-10)
    assert mpc.limit.contains(plan.theta)


def test_programs_against_two_solvers():
    """The minimum to 1e-8 and the verdict, on random starts, attitudes and tunings; Clarabel and HiGHS."""
    import clarabel
    import highspy
    from scipy.sparse import csc_matrix

    rng = np.random.default_rng(5)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-13
    seen = {SOLVED: 0, INFEASIBLE: 0}
    for case in range(150):
        tuning = Tuning(
            u_max=float(rng.uniform(0.02, 0.2)),
            n_c=int(rng.integers(1, 6)),
            rho=10.0 ** rng.uniform(-1, 3),
            tau=10.0 ** rng.uniform(-1, 3),
        )
        mpc, attitudes = program(tuning, tumble=envisat(rate=tuple(rng.normal(0.0, 0.05, 3))), window=120)
        y = rng.uniform(0.1, 8.0)
        start = np.array([rng.uniform(-y, y), y, rng.uniform(-y, y), *rng.normal(0.0, 0.03, 3)])
        mpc.assemble(attitudes)
        z, dual = np.empty(len(mpc.rows)), np.empty(len(mpc.high))
        arrays = (mpc.rows, mpc.shift, mpc.hessian, mpc.slope, mpc.low, mpc.high)
        status, _ = solve_from(*arrays, start, z, dual)
        moved = start @ mpc.shift
        high, low, gradient = mpc.high - moved, mpc.low - moved, mpc.slope @ start
        seen[status] += 1
        if status == INFEASIBLE:
            bounds = np.where(dual > 0.0, high, np.where(dual < 0.0, low, 0.0))
            assert dual @ bounds < 0.0
            assert np.abs(mpc.rows @ dual).max() < 1e-9 * np.abs(dual).max()
        else:
            assert (mpc.rows.T @ z <= high + 1e-10).all()
            assert (mpc.rows.T @ z >= low - 1e-10).all()
            scale = np.abs(gradient).max() + 1.0
            assert np.abs(mpc.hessian @ z + gradient + mpc.rows @ dual).max() < 1e-9 * scale
        two = np.isfinite(low)
        matrix = csc_matrix(np.vstack([mpc.rows.T, -mpc.rows.T[two]]))
        bound = np.append(high, -low[two])
        upper = csc_matrix(np.triu(mpc.hessian))
        cone = [clarabel.NonnegativeConeT(len(bound))]
        other = clarabel.DefaultSolver(upper, gradient, matrix, bound, cone, settings).solve()
        assert (str(other.status) == "PrimalInfeasible") == (status == INFEASIBLE), case
        if status == SOLVED:
            value = 0.5 * z @ mpc.hessian @ z + gradient @ z
            theirs = np.array(other.x)
            their_value = 0.5 * theirs @ mpc.hessian @ theirs + gradient @ theirs
            assert abs(value - their_value) <= 1e-8 * max(1.0, abs(value))
        highs = highspy.Highs()
        highs.silent()
        count = len(z)
        everywhere = np.full(count, -highspy.kHighsInf), np.full(count, highspy.kHighsInf)
        highs.addVars(count, *everywhere)
        for row, below, above in zip(mpc.rows.T, low, high, strict=True):
            highs.addRow(below, above, count, np.arange(count), row)
        highs.run()
        empty = highs.getModelStatus() == highspy.HighsModelStatus.kInfeasible
        assert empty == (status == INFEASIBLE), case
    assert min(seen.values()) > 20


def test_the_least_violation_is_least():
    """Against a linear program for t alone."""
    from scipy.optimize import linprog

    mpc, attitudes = program()
    start = np.array([4.8, 5.0, 2.0, 0.3, -0.2, 0.0])
    plan = mpc.plan(attitudes, start, soft=True)
    assert not plan.feasible
    assert plan.violation > 0.0
    moved = start @ mpc.shift
    two = np.isfinite(mpc.low)
    matrix = np.vstack([mpc.rows.T, -mpc.rows.T[two]])
    bound = np.append(mpc.high - moved, (moved - mpc.low)[two])
    give = np.append(mpc.give, mpc.give[two])
    cost = np.zeros(len(mpc.rows) + 1)
    cost[-1] = 1.0
    found = linprog(
        cost, np.hstack([matrix, -give[:, None]]), bound, bounds=[(None, None)] * 12 + [(0, None)]
    )
    outside = float(mpc.fixed_violation(attitudes, start))
    assert plan.violation == pytest.approx(max(found.fun, outside), abs=1e-7)
    assert np.abs(plan.inputs[0]).max() <= mpc.tuning.u_max + 1e-9


def test_the_polytope_leaves_out_only_what_others_imply():
    tumble, motion = envisat(), Sampled(MEAN_MOTION, 1.0)
    attitudes = tumble.nodes(1.0, 150)
    limit = theta_set(Tuning(), SHAPE, tumble, motion, attitudes)
    maps = equilibrium.inputs(motion, attitudes)
    points = np.random.default_rng(1).uniform([-12, 0, -12], [12, 12, 12], (4000, 3))
    whole = (np.abs(points @ maps.reshape(-1, 3).T) <= 0.075).all(axis=1) & SHAPE.faces().contains(points)
    few = (points @ limit.normals.T <= limit.high).all(axis=1)
    assert (whole == few).all()
    assert 50 < int(whole.sum()) < 3000
    assert len(limit.high) < 120


def test_the_loop_flies_it():
    from safestart.dynamics.cwh import Cwh
    from safestart.simulation.loop import fly
    from safestart.simulation.plant import Plant

    mpc, attitudes = program()
    plant = Plant(Cwh(MEAN_MOTION), envisat().attitude)
    record = fly(plant, [SHAPE.faces()], TrackingMpc(mpc, attitudes), START, steps=16, dt=1.0)
    path = record.paths[0]
    assert record.safe[0]
    assert all(command.feasible for command in path.commands)
    assert float(record.delta_v[0]) == pytest.approx(0.83, abs=0.05)
    state = START.copy()
    for k in range(16):
        node = path.states[np.searchsorted(path.times, float(k))].copy()
        np.testing.assert_allclose(node[:3], state[:3], atol=1e-9)
        state = mpc.plan(attitudes[k:], state).states[1]


@pytest.mark.parametrize(
    "make",
    [
        lambda: Tuning(u_max=0.0),
        lambda: Tuning(u_max=1e-300),
        lambda: theta_set(
            Tuning(theta_limit="zero"),
            DockingCorridor(y0=1.0),
            envisat(),
            Sampled(MEAN_MOTION, 1.0),
            envisat().nodes(1.0, 9),
        ),
        lambda: Tuning(n_c=31),
        lambda: Tuning(rho=0.0),
        lambda: Tuning(theta_limit="none"),
        lambda: DockingCorridor(c_x=0.0),
        lambda: Sampled(MEAN_MOTION, 300.0),
        lambda: Sampled(MEAN_MOTION, 0.0),
        lambda: envisat(rate=(0.0, 0.3, 0.0)).slow_enough(5.0),
        lambda: program(tightening=(np.zeros(36), np.full(35, 0.1))),
        lambda: program()[0].plan(np.zeros((3, 3, 3)), START),
    ],
)
def test_refusals(make):
    with pytest.raises(InvalidInput):
        make()


def test_theta_zero_keeps_the_target():
    mpc, attitudes = program(Tuning(n_c=12, theta_limit="zero"))
    plan = mpc.plan(attitudes, START)
    assert plan.feasible
    assert np.abs(plan.theta).max() < 1e-12
    assert not program(Tuning(n_c=6, theta_limit="zero"))[0].plan(attitudes, START).feasible
    assert isinstance(mpc, Program)
    assert math.isfinite(plan.cost)
