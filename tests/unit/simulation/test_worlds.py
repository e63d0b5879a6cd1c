"""The flown world: corridor at all times, thruster errors, two bodies with J2; and the sequence planner in it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from safestart.constraints.corridor import corridor_of
from safestart.control.forecast import flight_plan
from safestart.control.gains import PAPER
from safestart.control.sequence_mpc import SequenceMpc, SequencePlanner, start_verdict
from safestart.control.three_regimes import ThreeRegimes
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.dynamics.registry import MOTIONS
from safestart.dynamics.two_body import J2, Orbit, TwoBody, axes, gravity
from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.question import Question
from safestart.exact.watch import watch_of
from safestart.model.orbit import EARTH_RADIUS as RADIUS
from safestart.model.orbit import MU
from safestart.model.scenario import Floats, Rest, Scenario
from safestart.simulation.compiled_loop import fly
from safestart.simulation.loop import fly as fly_slowly
from safestart.simulation.noise import EXACT, Drawn, Errors, Truth, draws, truth_of
from safestart.simulation.plant import plant_of
from safestart.simulation.record import Record
from safestart.simulation.starts import start_states

N = 1.1e-3
TIMES = 0.005 * np.arange(1, 401)


def dense(scenario: Scenario, start: Floats, commands: Floats) -> tuple[Floats, Floats]:
    """Times and least face distances every 5 ms, each straight from its node."""
    corridor = corridor_of(scenario.corridor)
    x, when, least = start, [0.0], [(corridor.slack(start[:2]) / corridor.lengths).min()]
    moves = [(transition_matrix(N, t), input_matrix(N, t)) for t in TIMES.tolist()]
    for k, command in enumerate(commands):
        states = np.array([phi @ x + gamma @ command for phi, gamma in moves])
        angle = scenario.target.tumble_rate * (2.0 * k + TIMES)
        body = np.stack(
            [
                np.cos(angle) * states[:, 0] + np.sin(angle) * states[:, 1],
                np.cos(angle) * states[:, 1] - np.sin(angle) * states[:, 0],
            ],
            axis=1,
        )
        least += (corridor.slack(body) / corridor.lengths).min(axis=1).tolist()
        when += (2.0 * k + TIMES).tolist()
        x = states[-1]
    return np.array(when), np.array(least)


def approach(scenario: Scenario, start: Floats, model: str = "cwh", errors: Errors = EXACT) -> Record:
    """Sequence MPC from one start, 30 intervals of 2 s."""
    controller = SequenceMpc(Question(scenario, 2.0, 30))
    return fly_slowly(
        plant_of(scenario, model), [corridor_of(scenario.corridor)], controller, start, 30, 2.0, errors
    )


def test_the_corridor_is_watched_between_the_sub_steps() -> None:
    rng = np.random.default_rng(2)
    found = 0
    for omega, a_max in ((2.0, 0.05), (4.0, 0.1), (5.0, 0.1)):
        scenario = Scenario.of(omega, a_max)
        points = np.stack([rng.uniform(-20, 20, 40), rng.uniform(16, 40, 40)], axis=1)
        starts = start_states(scenario, points, Rest.LVLH)
        plan, corridor = flight_plan(scenario, PAPER, 2.0, 30), [corridor_of(scenario.corridor)]
        flights, nodes = fly(plan, starts, Truth(2)), fly(plan, starts, Truth(0))
        assert (flights.safe <= nodes.safe).all()
        for row in range(0, 40, 8):
            flown = fly_slowly(plant_of(scenario), corridor, ThreeRegimes(plan), starts[row], 30, 2.0)
            when, least = dense(scenario, starts[row], flown.paths[0].thrust)
            assert flights.safe[row] == (least.min() >= 0.0)
            if flights.safe[row]:
                assert flights.margin[row] == pytest.approx(least.min(), abs=2e-4)
                assert flights.margin[row] <= least.min() + 2e-5
            else:
                found += 1
                assert flights.violated_at[row] == pytest.approx(when[least < 0.0][0], abs=0.006)
                assert flown.violated_at[0] == pytest.approx(flights.violated_at[row], abs=1e-3)
    assert found >= 3


def test_thrusters_deliver_what_they_can() -> None:
    scenario = Scenario.of(2.0, 0.1)
    start = start_states(scenario, np.array([[5.0, 60.0]]), Rest.LVLH)[0]
    truth = truth_of("continuous", magnitude_sigma=0.1, direction_sigma=0.2, minimum_impulse=0.05)
    drawn = draws(truth, 7, np.array([3]), 30)
    flown = approach(scenario, start, errors=Drawn(truth, drawn[0]))
    sizes = 2.0 * np.linalg.norm(flown.paths[0].thrust, axis=1)
    assert ((sizes == 0.0) | (sizes >= 0.05)).all()
    assert flown.delta_v[0] == pytest.approx(sizes.sum())
    assert draws(truth, 7, np.array([3, 4]), 30)[0].tolist() == drawn[0].tolist()
    assert draws(Truth(), 7, np.array([3]), 30).size == 0
    with pytest.raises(InvalidInput, match="magnitude_sigma"):
        truth_of("continuous", magnitude_sigma=-0.1)


def test_gravity_is_the_gradient_of_its_potential() -> None:
    def potential(p: Floats) -> float:
        r = math.sqrt(float(p @ p))
        return MU / r * (1.0 - J2 * (RADIUS / r) ** 2 * 0.5 * (3.0 * (p[2] / r) ** 2 - 1.0))

    rng = np.random.default_rng(0)
    for _ in range(5):
        p = rng.normal(size=3)
        p *= 7e6 / np.linalg.norm(p)
        step = 50.0
        slope = [(potential(p + step * e) - potential(p - step * e)) / (2.0 * step) for e in np.eye(3)]
        np.testing.assert_allclose(gravity(p), slope, atol=1e-7)


def test_relative_motion_is_the_difference_of_two_orbits() -> None:
    orbit = Orbit.of(N)
    start = np.array([100.0, -2000.0, 30.0, 0.5, -0.3, 0.1])
    seen = TwoBody(orbit).start(start).fly(np.zeros(3), np.array([0.0, 150.0, 300.0]))
    target = orbit.state()
    rows, omega = axes(target)
    chaser = target + np.concatenate([rows.T @ start[:3], rows.T @ (start[3:] + np.cross(omega, start[:3]))])

    def absolute(state: Floats) -> Floats:
        def rates(_: float, y: Floats) -> Floats:
            return np.concatenate([y[3:], gravity(y[:3])])

        return solve_ivp(rates, (0.0, 300.0), state, "DOP853", rtol=1e-13, atol=1e-6).y[:, -1]

    ends = absolute(target), absolute(chaser)
    rows, omega = axes(ends[0])
    position = rows @ (ends[1] - ends[0])[:3]
    np.testing.assert_allclose(seen[-1, :3], position, atol=1e-3)
    np.testing.assert_allclose(
        seen[-1, 3:], rows @ (ends[1] - ends[0])[3:] - np.cross(omega, position), atol=1e-6
    )


def test_two_bodies_stay_close_to_cwh_near_the_target() -> None:
    scenario = Scenario.of(3.0, 0.1)
    start = start_states(scenario, np.array([[5.0, 40.0]]), Rest.LVLH)[0]
    flown = [approach(scenario, start, model) for model in MOTIONS]
    assert flown[0].safe[0]
    assert flown[1].safe[0]
    apart = np.abs(flown[0].paths[0].states[-1] - flown[1].paths[0].states[-1])[:3].max()
    assert 1e-6 < apart < 5e-3
    with pytest.raises(InvalidInput, match="mean_motion"):
        Orbit.of(0.0)


def test_the_tail_of_a_plan_is_admissible_to_its_end() -> None:
    scenario = Scenario.of(3.0, 0.1)
    planner = SequencePlanner(Question(scenario))
    for point in ((5.0, 40.0), (-20.0, 30.0), (-30.0, 60.0)):
        plan = planner.plan(0, np.array([*point, 0.0, 0.0]))
        assert plan.verdict is Verdict.GO
        assert np.hypot(*plan.thrust.T).max() <= 0.1
        for step in range(1, 30):
            left = Question(scenario, 2.0, 30 - step)
            watch = watch_of(left, step * 2.0 * scenario.target.tumble_rate)
            assert watch.minima(plan.nodes[step], plan.thrust[step:]).lowest >= plan.margin - 1e-6
            assert planner.kept(plan, 0, step, plan.nodes[step]) is plan
        drift = np.array([0.0, 0.0, 1.0, 1.0])
        assert planner.kept(plan, 0, 10, plan.nodes[10] + 1e-4 * drift) is plan
        assert planner.kept(plan, 0, 10, plan.nodes[10] + 0.1 * drift) is None


def test_disturbed_flights_are_planned_anew_and_say_when_they_could_not() -> None:
    scenario = Scenario.of(3.0, 0.1)
    truth = truth_of("continuous", position_sigma=0.1, velocity_sigma=0.01, magnitude_sigma=0.03)
    flights = []
    for case in range(6):
        start = start_states(scenario, np.array([[5.0 * case - 20.0, 35.0]]), Rest.LVLH)[0]
        drawn = draws(truth, 1, np.array([case]), 30)
        flights.append(approach(scenario, start, errors=Drawn(truth, drawn[0])))
    assert all(flown.safe[0] for flown in flights)
    labels = [[command.label for command in flown.paths[0].commands] for flown in flights]
    assert all(label[0] == "planned" for label in labels)
    assert {"planned", "kept"} == {name for label in labels for name in label[1:]}
    assert all(start_verdict(flown.paths[0].commands) is not None for flown in flights)
    # A hopeless start: the controller flies the least violation, and every step reports it.
    hopeless = start_states(scenario, np.array([[60.0, 42.0]]), Rest.LVLH)[0]
    flown = approach(scenario, hopeless)
    assert start_verdict(flown.paths[0].commands) is Verdict.NO_GO
    assert not flown.safe[0]
    assert flown.fallbacks[0] == flown.steps[0] > 0
