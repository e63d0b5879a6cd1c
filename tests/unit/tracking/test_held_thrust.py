"""Thrust held over the steps, and inputs in a ball: equilibria, dead-beat, flights, histories, certificates."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from safestart.control.tracking_mpc import equilibrium
from safestart.control.tracking_mpc.controller import TrackingMpc
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.theta_radius import bracket
from safestart.control.tracking_mpc.theta_set import theta_set
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import Tuning, input_sides
from safestart.dynamics.cwh import Cwh, system_matrix
from safestart.errors import InvalidInput
from safestart.simulation.loop import fly as loop_flight
from safestart.simulation.plant import Plant
from safestart.tracking.any_history import AnyHistory
from safestart.tracking.certificate import cost_decrease, recursion, shifts_needed
from safestart.tracking.flight import fly
from safestart.tracking.noisy_flight import Belief, NoisyFlights
from tests.unit.tracking.envisat import INERTIA, MEAN_MOTION, RATE, SHAPE, START, envisat, program


@pytest.mark.parametrize("period", [0.5, 1.0, 5.0])
def test_an_equilibrium_is_a_trajectory(period):
    motion = Sampled(MEAN_MOTION, period, held=True)
    attitudes = Rotation.random(40, random_state=3).as_matrix()
    theta = np.array([0.3, 0.7, -0.2])
    states = equilibrium.states(motion, attitudes) @ theta
    given = equilibrium.inputs(motion, attitudes) @ theta
    scale = np.abs(given).max()
    for k, one in enumerate(given):
        after = motion.after(states[k], attitudes[k].T @ one)
        np.testing.assert_allclose(after, states[k + 1], atol=1e-13 * max(1.0, scale * period))


def test_held_thrust_moves_as_an_integrator_says():
    motion, state, given = Sampled(MEAN_MOTION, 2.0, held=True), START + 0.1, np.array([0.03, -0.02, 0.05])
    push = np.concatenate([np.zeros(3), given / 2.0])
    flown = solve_ivp(
        lambda _, x: system_matrix(MEAN_MOTION) @ x + push, (0.0, 2.0), state, rtol=1e-12, atol=1e-14
    )
    np.testing.assert_allclose(motion.after(state, given), flown.y[:, -1], atol=1e-11)


@pytest.mark.parametrize("turn", [0.03, 0.087, 0.2])
def test_it_passes_close_to_theta(turn):
    """By n T turn / 8 and a fifth order in the turn per step; a target at rest in LVLH is met exactly."""
    motion = Sampled(MEAN_MOTION, 1.0, held=True)
    frames = Rotation.from_rotvec(np.outer(turn * np.arange(60.0), [0.6, 0.0, 0.8])).as_matrix()
    most = (MEAN_MOTION / 4.0 + 0.5 * turn**4) * turn
    assert np.abs(equilibrium.places(motion, frames) - np.eye(3)).max() < most
    still = np.broadcast_to(np.eye(3), (20, 3, 3))
    np.testing.assert_allclose(equilibrium.places(motion, still), still[:15], atol=1e-14)


@pytest.mark.parametrize("period", [0.5, 1.0, 2.0, 20.0])
def test_two_inputs_end_any_deviation(period):
    motion = Sampled(MEAN_MOTION, period, held=True)
    closed = motion.a + motion.b @ motion.dead_beat()
    assert np.abs(closed @ closed).max() <= 1e-12 * max(1.0, period)


def test_the_round_body_is_inside_the_ball():
    normals, bound = input_sides("ball", 0.075)
    corners = np.random.default_rng(0).normal(size=(20_000, 3))
    corners *= (bound / np.abs(corners @ normals.T).max(axis=1))[:, None]
    sizes = np.linalg.norm(corners, axis=1)
    assert sizes.max() <= 0.075
    assert sizes.max() > 0.0745
    assert sizes.min() >= bound * (1.0 - 1e-12)
    assert bound > 0.94 * 0.075
    assert len(normals) == 31


@pytest.mark.parametrize("limit", ["box", "ball"])
@pytest.mark.parametrize("held", [False, True])
def test_flights_keep_rows_and_certificate(limit, held):
    tumble, tuning = envisat("inertial"), Tuning(input_limit=limit)
    mpc, attitudes = program(tuning, tumble=tumble, window=330, held=held)
    flight = fly(mpc, tumble, attitudes, START, 40)
    assert flight.finished
    assert flight.least_slack >= -1e-9
    assert flight.settled(0.05) < 25
    sizes = np.abs(flight.inputs) if limit == "box" else np.linalg.norm(flight.inputs, axis=1)
    assert sizes.max() <= 0.075 + 1e-12
    shifts = shifts_needed(mpc.condensed.closed)
    assert all(recursion(mpc, attitudes[k:], plan, shifts).holds for k, plan in enumerate(flight.plans))
    assert cost_decrease(mpc, attitudes, flight) <= 1e-9
    state = START.copy()
    for k, plan in enumerate(flight.plans):
        np.testing.assert_allclose(plan.states[0], state, atol=1e-12)
        state = mpc.motion.after(state, attitudes[k].T @ plan.inputs[0])
    rates = np.ascontiguousarray(tumble.body.angular_velocity(np.arange(31.0)))
    flights = NoisyFlights(mpc, Belief(np.array(INERTIA), MEAN_MOTION), "soft", None)
    done = flights.fly(START, attitudes[:31].copy(), rates, np.zeros((31, 6)), np.ones(30))
    assert done.last_range == pytest.approx(float(flight.ranges[30]), abs=1e-6)
    assert done.largest_input <= 0.075 + 1e-12
    assert done.unplanned == 0


@pytest.mark.parametrize("limit", ["box", "ball"])
def test_the_bracket_of_theta(limit):
    """Sampled needs of theta at the bracket's ends, held thrust: at ``low`` never more than the limit."""
    tumble, motion = envisat("inertial"), Sampled(MEAN_MOTION, 1.0, held=True)
    low, high = bracket(tumble, motion, 0.075, limit)
    assert 0.8 * high < low <= high
    maps = equilibrium.inputs(motion, tumble.nodes(1.0, 3000))
    most = (
        np.linalg.norm(maps, axis=2).max() if limit == "box" else np.linalg.norm(maps, 2, axis=(1, 2)).max()
    )
    assert most * low <= 0.075
    assert most * high >= 0.075 * 0.98


@pytest.mark.parametrize("ball", [False, True])
def test_any_history_of_held_thrust(ball):
    """Feasible ends are ends: a little beyond them the answer is proved to be no; histories obey motion and limits."""
    motion, attitudes = Sampled(MEAN_MOTION, 1.0, held=True), envisat().nodes(1.0, 41)
    histories = AnyHistory(motion, SHAPE, 0.075, attitudes, ball=ball)
    along, base = np.array([1.0, 0, 0, 0, 0, 0]), np.array([0, 6.25, 0, 0, 0, 0])
    low, high = histories.extent(base, along)
    assert -6.35 <= low < 0.0 < high <= 6.35
    for end, step in ((low, -1.0), (high, 1.0)):
        assert histories.answer(base + (end - 1e-4 * step) * along).feasible
        beyond = histories.answer(base + (end + 1e-2 * step) * along)
        assert not beyond.feasible
        assert beyond.proved
    inside = histories.answer(base)
    assert SHAPE.faces().slack(inside.positions).min() >= -1e-7
    state = base.copy()
    lvlh = np.einsum("kji,kj->ki", attitudes, inside.positions)
    for k in range(40):
        given = np.linalg.solve(motion.b[:3], lvlh[k + 1] - motion.a[:3] @ state)
        size = np.linalg.norm(given) if ball else np.abs(attitudes[k] @ given).max()
        assert size <= 0.075 * (1.0 + 1e-3)
        state = motion.after(state, given)


@pytest.mark.parametrize("held", [False, True])
def test_the_loop_flies_the_same(held):
    mpc, attitudes = program(held=held)
    plant = Plant(Cwh(MEAN_MOTION), envisat().attitude)
    record = loop_flight(plant, [SHAPE.faces()], TrackingMpc(mpc, attitudes), START, steps=16, dt=1.0)
    path, flight = record.paths[0], fly(mpc, envisat(), attitudes, START, 16)
    assert len(flight.states) == 17
    nodes = path.states[np.searchsorted(path.times, np.arange(17.0) - 1e-6)]
    # An impulse is in the velocity of one and not yet in that of the other.
    shown = 6 if held else 3
    np.testing.assert_allclose(nodes[:, :shown], flight.states[:, :shown], atol=1e-9)


def test_the_printed_limit_is_about_impulses():
    with pytest.raises(InvalidInput, match="theta_limit"):
        program(Tuning(theta_limit="printed"), held=True)
    with pytest.raises(InvalidInput, match="input_limit"):
        Tuning(input_limit="disk")


@pytest.mark.parametrize("limit", ["polytope", "corners"])
def test_far_thetas_do_not_keep_it_from_the_port(limit):
    """A spin about an axis in the corridor needs no input along it: the set of thetas reaches 100 km there."""
    ball = ((1000.0, 0.0, 0.0), (0.0, 1000.0, 0.0), (0.0, 0.0, 1000.0))
    tumble = Tumble(ball, (1.0, 0.0, 0.0, 0.0), (0.0, RATE, RATE), MEAN_MOTION, "lvlh")
    tuning = Tuning(u_max=0.15, n_c=10, tau=10.0, theta_limit=limit)
    mpc, attitudes = program(tuning, period=2.0, tumble=tumble, window=400, held=True)
    flight = fly(mpc, tumble, attitudes, START, 60)
    assert flight.finished
    assert flight.ranges[-1] < 1e-3
    shifts = shifts_needed(mpc.condensed.closed)
    assert all(recursion(mpc, attitudes[k:], plan, shifts).holds for k, plan in enumerate(flight.plans))


def test_faces_lean_in_by_all_that_it_passes_beside():
    """Thetas at corners of the set: the places where the chaser is then are in the corridor, at every node."""
    tumble, motion = envisat("inertial"), Sampled(MEAN_MOTION, 5.0, held=True)
    attitudes = tumble.nodes(5.0, 300)
    limit = theta_set(Tuning(u_max=0.5), SHAPE, tumble, motion, attitudes)
    rng, faces, places = np.random.default_rng(4), SHAPE.faces(), equilibrium.places(motion, attitudes)
    worst = np.inf
    for direction in rng.normal(size=(40, 3)):
        found = linprog(-direction, limit.normals, limit.high, bounds=(None, None))
        assert found.status == 0
        assert limit.contains(found.x, 1e-7)
        worst = min(worst, float(faces.slack(places @ found.x).min()))
    assert worst >= -1e-9
