"""The closed loop: exact drift, thrust limit, a NumPy twin, and the same loop with OSQP."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.peers.osqp_loop import OsqpLoop
from safestart.attitude.body_frame import lvlh_to_body
from safestart.attitude.spin import spin_of
from safestart.constraints.corridor import corridor_of
from safestart.control.forecast import flight_plan
from safestart.control.gains import PAPER, TUNED, Gains
from safestart.control.regimes import control_law, nominal_command
from safestart.control.safety_filter import filter_command
from safestart.control.three_regimes import ThreeRegimes
from safestart.dynamics.cwh import input_matrix, transition_matrix
from safestart.errors import InvalidInput
from safestart.model.scenario import Rest, Scenario
from safestart.simulation.compiled_loop import fly
from safestart.simulation.loop import fly as fly_slowly
from safestart.simulation.noise import CONTINUOUS, Drawn, Truth, draws, truth_of
from safestart.simulation.plant import plant_of
from safestart.simulation.record import Path, Record
from safestart.simulation.starts import start_states, steps_of
from safestart.simulation.watch import samples_of

N = 1.1e-3
STARTS = [(5.0, 40.0), (-20.0, 60.0), (0.0, 30.0), (30.0, 35.0), (60.0, 80.0), (-80.0, 100.0), (0.5, 3.0)]


def twin(scenario: Scenario, gains: Gains, start: np.ndarray, steps: int, dt: float, d: int):  # type: ignore[no-untyped-def]
    """The loop in NumPy, each sub-step straight from the node by Phi(s dt / 3) and B_d(s dt / 3)."""
    omega = scenario.target.tumble_rate
    corridor = corridor_of(scenario.corridor, d)
    plan = flight_plan(scenario, gains, dt, steps, planar=d == 2)
    law = control_law(scenario, gains, dt)
    r0 = float(np.linalg.norm(start[:3]))
    v_max = gains.closing_factor * math.sqrt(scenario.chaser.max_acceleration * r0)
    x, previous = start, np.zeros(d)
    states, commands, margins = [x], [], [(corridor.slack(x[:d]) / corridor.lengths).min()]
    for k in range(steps):
        if margins[-1] < 0.0:
            break
        time = k * dt
        cos, sin = math.cos(omega * time), math.sin(omega * time)
        nominal = np.array(nominal_command(*x.tolist(), time, cos, sin, r0, v_max, law)[:3])
        previous, _ = filter_command(plan, k, x, nominal, previous)
        commands.append(previous)
        node = x
        for s in (1, 2, 3):
            tau = s * dt / 3.0
            x = transition_matrix(N, tau) @ node + input_matrix(N, tau)[:, :d] @ previous
            body, _ = lvlh_to_body(x[:3], x[3:], omega, time + tau)
            states.append(x)
            margins.append((corridor.slack(body[:d]) / corridor.lengths).min())
            if margins[-1] < 0.0:
                break
    return np.array(states), np.array(commands), np.array(margins)


def trace(
    scenario: Scenario,
    position: tuple[float, ...],
    rest: Rest = Rest.LVLH,
    gains: Gains = TUNED,
    t_sim: float = 60.0,
) -> tuple[Record, Path]:
    """One flight of the compiled loop with its path at every sub-step."""
    plan = flight_plan(scenario, gains, 2.0, steps_of(t_sim, 2.0), planar=len(position) == 2)
    record = fly(plan, start_states(scenario, np.array([position]), rest), keep_paths=True)
    return record, record.paths[0]


@pytest.mark.parametrize("gains", [TUNED, PAPER], ids=["tuned", "paper"])
@pytest.mark.parametrize("rest", list(Rest))
def test_flight_equals_its_numpy_twin(gains: Gains, rest: Rest) -> None:
    scenario = Scenario.of(3.0, 0.1)
    for position in [*STARTS, (5.0, 40.0, 8.0), (-3.0, 30.0, -20.0)]:
        flown, path = trace(scenario, position, rest, gains)
        d = len(position)
        states, commands, margins = twin(scenario, gains, path.states[0], 30, 2.0, d)
        assert len(states) == len(path.states)
        np.testing.assert_allclose(path.states, states, atol=1e-8)
        np.testing.assert_allclose(path.thrust[:, :d], commands, atol=1e-9)
        distances = path.distances(corridor_of(scenario.corridor, d), spin_of(scenario.target))
        np.testing.assert_allclose(distances.min(axis=1), margins, atol=1e-8)
        assert flown.margin[0] == pytest.approx(margins.min(), abs=1e-8)
        assert flown.safe[0] == (margins.min() >= 0.0)
        assert flown.delta_v[0] == pytest.approx(2.0 * np.linalg.norm(commands, axis=1).sum())


def test_free_drift_is_phi() -> None:
    # The least thrust there is leaves the CWH drift, up to what it can move; the corridor is wide enough to hold it.
    a_max = 1e-6
    scenario = replace(Scenario.of(0.0, a_max), corridor=replace(Scenario.of(0, 1).corridor, c_x=50.0))
    _, path = trace(scenario, (10.0, 100.0, 5.0), t_sim=300.0)
    assert len(path.times) == 451
    for time, state in zip(path.times, path.states, strict=True):
        expected = transition_matrix(N, float(time)) @ path.states[0]
        assert np.abs(state - expected)[:3].max() <= 0.6 * a_max * float(time) ** 2 + 1e-9
        assert np.abs(state - expected)[3:].max() <= 1.2 * a_max * float(time) + 1e-9
    # The gravity gradient alone moves it a hundred times farther than that.
    assert np.abs(path.states[-1] - path.states[0])[:3].max() > 1.0


def test_nothing_but_thrust_moves_the_chaser() -> None:
    # Replay of the commands alone, one matrix product per interval: no blending, no projection of the state.
    scenario = Scenario.of(2.0, 0.1)
    flown, path = trace(scenario, (5.0, 60.0), t_sim=400.0)
    assert flown.safe[0]
    assert path.commands[-1].label == "hold"
    x = path.states[0]
    for thrust in path.thrust:
        x = transition_matrix(N, 2.0) @ x + input_matrix(N, 2.0) @ thrust
    np.testing.assert_allclose(path.states[-1], x, atol=1e-8)
    # It arrives: the hold point is 1.5 m outside the hold plane.
    body = path.seen_from(spin_of(scenario.target))
    np.testing.assert_allclose(body[-1, :3], [0.0, 2.0, 0.0], atol=0.02)


@pytest.mark.parametrize("planar", [True, False])
def test_thrust_stays_in_the_disk(planar: bool) -> None:
    rng = np.random.default_rng(5)
    for omega, a_max in ((1.0, 0.02), (3.0, 0.1), (5.0, 0.05)):
        scenario = Scenario.of(omega, a_max)
        starts = np.zeros((300, 6))
        starts[:, 1] = rng.uniform(1.0, 150.0, 300)
        starts[:, 0] = rng.uniform(-1.4, 1.4, 300) * starts[:, 1]
        starts[:, 3:5] = rng.normal(size=(300, 2))
        if not planar:
            starts[:, 2] = rng.uniform(-1.4, 1.4, 300) * starts[:, 1]
        flights = fly(flight_plan(scenario, PAPER, 2.0, 30, planar=planar), starts)
        assert flights.finite.all()
        assert flights.peak.max() <= a_max * (1.0 + 1e-12)
        assert flights.fallbacks.sum() > 0
        assert (flights.delta_v <= a_max * 2.0 * flights.steps * (1.0 + 1e-12)).all()


def test_space_and_plane_agree_in_the_plane() -> None:
    scenario = Scenario.of(3.0, 0.1)
    starts = start_states(scenario, np.array(STARTS), Rest.LVLH)
    plane = fly(flight_plan(scenario, TUNED, 2.0, 30), starts)
    space = fly(flight_plan(scenario, TUNED, 2.0, 30, planar=False), starts)
    np.testing.assert_array_equal(plane.safe, space.safe)
    np.testing.assert_array_equal(plane.steps, space.steps)
    np.testing.assert_allclose(plane.delta_v, space.delta_v, atol=1e-9)
    # The two faces that only space has can only lower the margin.
    assert (space.margin <= plane.margin + 1e-9).all()


@pytest.mark.parametrize("d", [2, 3])
def test_agrees_with_the_loop_in_python_with_osqp(d: int) -> None:
    for omega in (1.0, 3.0):
        scenario = Scenario.of(omega, 0.1)
        peer = OsqpLoop(scenario, TUNED, 2.0, 30, planar=d == 2, tolerance=1e-9)
        positions = np.array(STARTS)
        if d == 3:
            positions = np.column_stack([positions, 0.2 * positions[:, 1]])
        starts = start_states(scenario, positions, Rest.LVLH)
        for position, other in zip(positions, peer.fly_all(starts), strict=True):
            ours, path = trace(scenario, position)
            assert ours.safe[0] == other.safe
            assert len(path.states) == len(other.states)
            np.testing.assert_allclose(path.states, other.states, atol=1e-5)
            assert ours.margin[0] == pytest.approx(other.margin, abs=1e-5)
            assert ours.fallbacks[0] == other.infeasible


def test_a_start_outside_is_not_flown() -> None:
    scenario = Scenario.of(1.0, 0.1)
    flights = fly(flight_plan(scenario, TUNED, 2.0, 5), np.array([[50.0, 1.0, 0.0, 0.0, 0.0, 0.0]]))
    assert flights.margin[0] < 0.0
    assert flights.steps[0] == 0
    assert not flights.safe[0]


def test_a_state_that_is_not_a_number_is_reported() -> None:
    scenario = Scenario.of(1.0, 0.1)
    starts = np.zeros((2, 6))
    starts[:, 1] = 50.0
    starts[1, 3] = math.nan
    flights = fly(flight_plan(scenario, TUNED, 2.0, 5), starts)
    assert flights.finite.tolist() == [True, False]
    assert not flights.safe[1]


def test_bad_input_raises() -> None:
    scenario = Scenario.of(1.0, 0.1)
    plan = flight_plan(scenario, TUNED, 2.0, 5)
    with pytest.raises(InvalidInput, match="shape"):
        fly(plan, np.zeros((3, 4)))
    with pytest.raises(InvalidInput, match="planar"):
        fly(plan, np.ones((1, 6)))
    with pytest.raises(InvalidInput, match="positions"):
        start_states(scenario, np.zeros(3), Rest.LVLH)
    for times in ((0.0, 2.0), (math.inf, 2.0), (60.0, 0.0), (60.0, math.nan)):
        with pytest.raises(InvalidInput, match="more than 0 s"):
            steps_of(*times)


def test_flight_time_is_rounded_up_to_whole_intervals() -> None:
    assert [steps_of(60.0, 2.0), steps_of(60.0, 7.0), steps_of(0.3, 0.1), steps_of(1.0, 2.0)] == [30, 9, 3, 1]


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("preset", [TUNED, PAPER], ids=["tuned", "paper"])
def test_compiled_and_slow_loop_fly_the_same(preset: Gains, d: int) -> None:
    """The same controller, plant and constraint in the loop over any of them: same commands, margins and counts."""
    rng = np.random.default_rng(11)
    noise = truth_of(position_sigma=0.1, velocity_sigma=0.01, magnitude_sigma=0.03, direction_sigma=0.02)
    violated = fallbacks = 0
    for omega, truth in ((1.0, Truth(CONTINUOUS)), (3.0, Truth(CONTINUOUS)), (2.0, noise)):
        if truth.noisy and d == 3:
            continue
        scenario = Scenario.of(omega, 0.1)
        points = np.stack(
            [rng.uniform(-40, 40, 12), rng.uniform(10, 90, 12), rng.uniform(-20, 20, 12)], axis=1
        )
        starts = start_states(scenario, points[:, :d], Rest.LVLH)
        drawn = draws(truth, 5, np.arange(12), 30)
        # As many samples as the slow loop takes: only then do both see the same minima.
        samples = samples_of(spin_of(scenario.target), 2.0)
        plan = flight_plan(scenario, preset, 2.0, 30, planar=d == 2, substeps=samples)
        quick = fly(plan, starts, truth, drawn, keep_paths=True)
        for row in range(12):
            slow = fly_slowly(
                plant_of(scenario), [corridor_of(scenario.corridor, d)], ThreeRegimes(plan), starts[row], 30, 2.0,
                Drawn(truth, drawn[row] if truth.noisy else np.empty((0, 6))),
            )  # fmt: skip
            assert slow.safe[0] == quick.safe[row]
            assert slow.steps[0] == quick.steps[row]
            assert slow.fallbacks[0] == quick.fallbacks[row]
            assert slow.margin[0] == pytest.approx(quick.margin[row], abs=1e-6)
            assert slow.violated_at[0] == pytest.approx(quick.violated_at[row], abs=1e-4)
            assert slow.delta_v[0] == pytest.approx(quick.delta_v[row], abs=1e-9)
            assert slow.peak[0] == pytest.approx(quick.peak[row], abs=1e-9)
            asked = [(c.label, c.feasible) for c in slow.paths[0].commands]
            assert asked == [(c.label, c.feasible) for c in quick.paths[row].commands]
            np.testing.assert_allclose(slow.paths[0].thrust, quick.paths[row].thrust, atol=1e-9)
            violated += not slow.safe[0]
            fallbacks += int(slow.fallbacks[0])
    assert violated > 3
    assert fallbacks > 3
