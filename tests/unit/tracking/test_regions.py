"""Which starts the controller can take and which any history can: the counts of our study, at paper 002's set-up."""

import numpy as np
import pytest

from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.tuning import Tuning
from safestart.errors import InvalidInput
from safestart.tracking.any_history import AnyHistory
from safestart.tracking.region import by_any_history, by_flight, by_program, grid_of
from tests.unit.tracking.envisat import MEAN_MOTION, SHAPE, envisat, program

GRID = grid_of(SHAPE, 30)
LIMITS = ("polytope", "corners", "printed", "zero")
ONE_PER_CENT = 9


@pytest.mark.parametrize(
    ("period", "u_max", "exact", "counts"),
    [
        (0.5, 0.075, 831, (827, 650, 164, 1)),
        (1.0, 0.025, 618, (53, 33, 13, 0)),
        (1.0, 0.075, 777, (464, 283, 100, 1)),
        (1.0, 0.15, 822, (822, 793, 391, 2)),
        (2.0, 0.075, 682, (238, 180, 90, 2)),
    ],
)
def test_the_counts_of_the_study(period, u_max, exact, counts):
    assert len(GRID.points) == 930
    histories = _histories(period, u_max)
    reachable = by_any_history(histories, np.eye(3), GRID)
    assert abs(int(reachable.sum()) - exact) <= ONE_PER_CENT
    for limit, count in zip(LIMITS, counts, strict=True):
        mpc, attitudes = program(Tuning(u_max=u_max, theta_limit=limit), period, window=int(600 / period))
        taken = by_program(mpc, attitudes, GRID)
        assert abs(int(taken.sum()) - count) <= ONE_PER_CENT, limit
        assert not (taken & ~reachable).any()


def test_layers_and_flights():
    """Layers of z are layers of the same grid; flights arrive from what the program takes, and only from there."""
    grid = grid_of(SHAPE, 8, (0.0, 1.5))
    assert len(grid_of(SHAPE, 8).points) == int((grid.points[:, 2] == 0.0).sum()) < len(grid.points)
    assert SHAPE.faces().contains(grid.points).all()
    tumble = envisat("inertial")
    mpc, attitudes = program(tumble=tumble, window=340)
    taken = by_program(mpc, attitudes, grid)
    reachable = by_any_history(AnyHistory(mpc.motion, SHAPE, 0.075, attitudes[:61]), attitudes[0], grid)
    assert not (taken & ~reachable).any()
    arrives = by_flight(mpc, tumble, attitudes, grid, 60, taken)
    assert (arrives == taken).all()
    few = by_flight(mpc, tumble, attitudes, grid, 15, taken)
    assert 0 < int(few.sum()) < int(taken.sum())
    with pytest.raises(InvalidInput, match="z_m"):
        grid_of(SHAPE, 2, (9.0,))


def test_longer_horizons_reach_more():
    reachable = by_any_history(_histories(1.0, 0.075), np.eye(3), GRID)
    for n_c, count in ((10, 748), (20, 777)):
        mpc, attitudes = program(Tuning(n_c=n_c), window=400)
        assert abs(int(by_program(mpc, attitudes, GRID).sum()) - count) <= 3
    mpc, attitudes = program(Tuning(n_c=35, n_lqr=35, theta_limit="zero"), window=400)
    assert abs(int(by_program(mpc, attitudes, GRID).sum()) - 771) <= ONE_PER_CENT
    assert abs(int(reachable.sum()) - 777) <= ONE_PER_CENT


@pytest.mark.parametrize("ball", [False, True])
def test_single_answers_agree_with_intervals(ball):
    histories = _histories(1.0, 0.075, ball)
    reachable = by_any_history(histories, np.eye(3), GRID)
    states = GRID.states(np.eye(3))
    unproved = 0
    for index in range(5, 930, 60):
        answer = histories.answer(states[index])
        assert answer.feasible == reachable[index]
        assert not (answer.proved and answer.feasible)
        unproved += not answer.feasible and not answer.proved
        slack = SHAPE.faces().slack(answer.positions).min()
        assert slack >= -max(answer.violation, 0.0) - 1e-6
    assert unproved == 0


def test_a_ball_of_inputs_reaches_less_than_its_box():
    box = by_any_history(_histories(1.0, 0.075), np.eye(3), GRID)
    ball = by_any_history(_histories(1.0, 0.075, True), np.eye(3), GRID)
    assert not (ball & ~box).any()
    assert 0 < int(ball.sum()) < int(box.sum())


def test_histories_against_a_plain_linear_program():
    """The same question over inputs in place of positions, by HiGHS."""
    from scipy.optimize import linprog

    motion, attitudes = Sampled(MEAN_MOTION, 1.0), envisat().nodes(1.0, 61)
    faces, steps = SHAPE.faces(), 60
    reach = np.zeros((steps + 1, 6, 3 * steps))
    for k in range(steps):
        reach[k + 1] = motion.a @ reach[k]
        reach[k + 1, 3:, 3 * k : 3 * k + 3] += attitudes[k].T
    along, base = np.array([1.0, 0, 0, 0, 0, 0]), np.array([0, 8.25, 0, 0, 0, 0])
    rows, room, power = [], [], np.eye(6)
    for k in range(steps + 1):
        face = faces.normals @ attitudes[k]
        rows.append(np.hstack([face @ reach[k, :3], (face @ (power @ along)[:3])[:, None]]))
        room.append(faces.offsets - face @ (power @ base)[:3])
        power = motion.a @ power
    bounds = [(-0.075, 0.075)] * (3 * steps) + [(None, None)]
    ends = []
    for sign in (1.0, -1.0):
        cost = np.zeros(3 * steps + 1)
        cost[-1] = sign
        ends.append(linprog(cost, np.vstack(rows), np.concatenate(room), bounds=bounds).x[-1])
    assert _histories(1.0, 0.075).extent(base, along) == pytest.approx(tuple(ends), abs=1e-6)


def _histories(period, u_max, ball=False):
    attitudes = envisat().nodes(period, int(60 / period) + 1)
    return AnyHistory(Sampled(MEAN_MOTION, period), SHAPE, u_max, attitudes, ball=ball)
