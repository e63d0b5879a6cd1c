"""The loop over parts that it has never seen, its watch against brute force, and the compiled flight beside it."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from safestart.attitude.attitude import to_body
from safestart.attitude.spin import Spin
from safestart.constraints.corridor import corridor_of, faces_about_z, faces_at, polyhedron
from safestart.control.controller import Command
from safestart.dynamics.cwh import Cwh, system_matrix
from safestart.dynamics.two_body import Orbit, TwoBody
from safestart.errors import InvalidInput
from safestart.model.scenario import CorridorShape, Floats
from safestart.simulation.loop import fly, fly_watched
from safestart.simulation.noise import EXACT, Drawn, Exact, draws, truth_of
from safestart.simulation.planar import PlanarFlight, watched_flight
from safestart.simulation.plant import Plant
from safestart.simulation.record import Record
from safestart.simulation.watch import WatchedFlight
from tests.unit.simulation.parts import Damper, DoubleIntegrator, KeepOut, Nodding

START = np.array([3.0, 60.0, 2.0, 0.2, -1.0, 0.1])
SHAPE = CorridorShape()


class Given:
    """Plays a list of commands."""

    def __init__(self, commands: list[Command]) -> None:
        self.commands = commands

    def begin(self, state: Floats) -> None:
        pass

    def command(self, k: int, state: Floats) -> Command:
        return self.commands[k]


def test_new_parts_fly_in_the_loop() -> None:
    """A motion, an attitude, a constraint and a controller that safestart does not know, against an integrator."""
    plant = Plant(DoubleIntegrator(), Nodding(0.3, 0.05))
    damper = Damper(0.08)
    record = fly(plant, [corridor_of(SHAPE, 3), KeepOut(10.0)], damper, START, 20, 2.0)
    assert record.safe.tolist() == [True]
    assert record.steps.tolist() == [20]
    assert len(damper.started) == 1
    path = record.paths[0]
    assert 0 < record.fallbacks[0] == sum(not command.feasible for command in path.commands) < 20
    assert record.peak[0] == pytest.approx(0.08)
    assert record.delta_v[0] == pytest.approx(2.0 * np.linalg.norm(path.thrust, axis=1).sum())
    for k, thrust in enumerate(path.thrust):
        begin, end = path.states[k], path.states[k + 1]
        np.testing.assert_allclose(end[3:], begin[3:] + 2.0 * thrust, atol=1e-12)
        np.testing.assert_allclose(end[:3], begin[:3] + begin[3:] + end[3:], atol=1e-12)
    np.testing.assert_array_equal(path.times, 2.0 * np.arange(21))
    body = path.seen_from(plant.attitude)
    np.testing.assert_allclose(
        path.distances(corridor_of(SHAPE, 3), plant.attitude),
        corridor_of(SHAPE, 3).slack(body[:, :3]) / corridor_of(SHAPE, 3).lengths,
        atol=1e-12,
    )


def test_new_parts_fly_with_errors_in_space() -> None:
    """Each flight meets its own draws, and the same ones again."""
    plant = Plant(DoubleIntegrator(), Nodding(0.3, 0.05))
    truth = truth_of(position_sigma=0.1, velocity_sigma=0.01, magnitude_sigma=0.02, direction_sigma=0.01)
    drawn = draws(truth, 1, np.arange(2), 20, planar=False)
    flown = [
        fly(plant, [corridor_of(SHAPE, 3)], Damper(0.08), START, 20, 2.0, Drawn(truth, drawn[case]))
        for case in (0, 1, 0)
    ]
    ends = [record.paths[0].states[-1] for record in flown]
    assert (ends[0] == ends[2]).all()
    assert np.abs(ends[0] - ends[1]).min() > 1e-4
    both = Record.joined(flown[:2])
    assert len(both) == len(both.paths) == 2
    assert both.delta_v.tolist() == [flown[0].delta_v[0], flown[1].delta_v[0]]


@pytest.mark.parametrize(
    "attitude",
    [Spin(0.03), Spin(-0.05, (1.0, 2.0, -1.0), 0.4), Nodding(0.8, 0.11)],
    ids=["z", "tilted", "nodding"],
)
def test_violations_between_samples_are_found(attitude: Spin | Nodding) -> None:
    """Margin and first violation against the same flight looked at every 2 ms."""
    rng = np.random.default_rng(4)
    plant = Plant(Cwh(1.1e-3), attitude)
    constraints = [corridor_of(SHAPE, 3), KeepOut(30.0)]
    violated = 0
    for _ in range(12):
        start = START + rng.normal(size=6) * [14.0, 10.0, 14.0, 0.4, 0.4, 0.4]
        commands = [Command(rng.normal(size=3) * 0.05) for _ in range(12)]
        record = fly(plant, constraints, Given(commands), start, 12, 2.0)
        times = 0.002 * np.arange(12_001)
        state, rows = start, [start[None]]
        for command in commands:
            flown = solve_ivp(
                lambda _, x, u=command.thrust: system_matrix(1.1e-3) @ x + np.concatenate([np.zeros(3), u]),
                (0.0, 2.0), state, "DOP853", rtol=1e-12, atol=1e-12, t_eval=times[1:1001],
            )  # fmt: skip
            rows.append(flown.y.T)
            state = flown.y[:, -1]
        states = np.concatenate(rows)
        least = np.concatenate([c.room(times, states, attitude)[0] for c in constraints], axis=1).min(axis=1)
        if record.safe[0]:
            assert record.margin[0] == pytest.approx(least.min(), abs=1e-4)
            assert record.margin[0] <= least.min() + 1e-6
            np.testing.assert_allclose(record.paths[0].states[-1], states[-1], atol=1e-7)
        else:
            violated += 1
            assert least.min() < 1e-6
            assert record.violated_at[0] == pytest.approx(times[np.argmax(least < 0.0)], abs=0.003)
            assert record.margin[0] <= 0.0
    assert 2 <= violated <= 11


def test_rates_of_the_corridor_are_derivatives() -> None:
    attitude, h = Spin(0.07, (0.3, -0.5, 0.8), 0.2), 1e-4
    times = np.array([0.0, 5.0, 17.0])
    states = np.random.default_rng(1).normal(size=(3, 6)) * [40.0, 40.0, 40.0, 1.0, 1.0, 1.0]
    corridor = polyhedron(
        np.random.default_rng(2).normal(size=(4, 3)), np.full(4, 50.0), ("a", "b", "c", "d")
    )
    value, rate = corridor.room(times, states, attitude)
    ahead, behind = states.copy(), states.copy()
    ahead[:, :3] += h * states[:, 3:]
    behind[:, :3] -= h * states[:, 3:]
    rise = corridor.room(times + h, ahead, attitude)[0] - corridor.room(times - h, behind, attitude)[0]
    np.testing.assert_allclose(rate, rise / (2.0 * h), atol=1e-7)
    body = to_body(attitude, times, states)
    np.testing.assert_allclose(value, corridor.slack(body[:, :3]) / corridor.lengths, atol=1e-12)


def test_faces_turned_about_z_are_the_general_ones_in_every_bit() -> None:
    angles = np.random.default_rng(3).uniform(-7.0, 7.0, (5, 4))
    for d in (2, 3):
        normals = corridor_of(SHAPE, d).normals
        np.testing.assert_array_equal(
            faces_about_z(normals, angles), faces_at(normals, Spin(0.0).turned_by(angles))
        )


@pytest.mark.parametrize(
    "spin", [Spin(0.06), Spin(-0.03, phase=0.3), Spin(0.04, (0.0, 0.0, -2.0)), Spin(0.0)]
)
def test_the_compiled_flight_is_the_general_one(spin: Spin) -> None:
    rng = np.random.default_rng(7)
    plant, corridor = Plant(Cwh(1.1e-3), spin), [corridor_of(SHAPE)]
    outcomes = set()
    for _ in range(40):
        start = np.zeros(6)
        start[[0, 1, 3, 4]] = rng.normal(size=4) * [12.0, 15.0, 0.4, 0.4] + [0.0, 45.0, 0.0, -0.5]
        commands = [Command(np.append(rng.normal(size=2) * 0.05, 0.0)) for _ in range(15)]
        commands[4] = Command(commands[4].thrust, impulse=np.array([0.1, -0.2, 0.0]))
        compiled = watched_flight(plant, corridor, start, 2.0)
        assert isinstance(compiled, PlanarFlight)
        one = fly_watched(compiled, Given(commands), 15, 2.0, EXACT)
        other = fly_watched(WatchedFlight(plant, corridor, start, 2.0), Given(commands), 15, 2.0, EXACT)
        assert one.margin[0] == pytest.approx(other.margin[0], abs=1e-9)
        assert one.violated_at[0] == pytest.approx(other.violated_at[0], abs=1e-7)
        assert one.steps == other.steps
        assert one.delta_v == other.delta_v
        outcomes.add(bool(one.safe[0]))
        last = -1 if one.safe[0] else -2
        if len(one.paths[0].times) > 1:
            np.testing.assert_allclose(one.paths[0].states[:last], other.paths[0].states[:last], atol=1e-9)
    assert outcomes == {True, False}


def test_a_planar_corridor_is_not_turned_out_of_its_plane() -> None:
    plant = Plant(Cwh(1.1e-3), Spin(0.05, (1.0, 0.0, 1.0)))
    with pytest.raises(InvalidInput, match="corridor"):
        fly(plant, [corridor_of(SHAPE)], Damper(0.1), START, 3, 2.0)
    with pytest.raises(InvalidInput, match="start"):
        fly(plant, [], Damper(0.1), START[:4], 3, 2.0)


def test_a_flight_without_constraints_and_one_that_leaves_the_numbers() -> None:
    plant = Plant(DoubleIntegrator(), Spin(0.0))
    free = fly(plant, [], Damper(0.1), START, 3, 2.0)
    assert free.safe[0]
    assert math.isinf(free.margin[0])
    broken = fly(plant, [KeepOut(1.0)], Given([Command(np.full(3, math.nan))] * 3), START, 3, 2.0)
    assert not broken.safe[0]
    assert not broken.finite[0]
    assert broken.steps[0] == 1


def test_noise_in_space_is_what_its_sigmas_say() -> None:
    truth = truth_of(position_sigma=0.5, velocity_sigma=0.02, magnitude_sigma=0.1, direction_sigma=0.05)
    drawn = draws(truth, 3, np.arange(1), 20_000, planar=False)[0]
    errors, thrust = Drawn(truth, drawn), np.array([0.03, -0.04, 0.12])
    seen = np.array([errors.seen(k, START) - START for k in range(len(drawn))])
    np.testing.assert_allclose(seen.std(axis=0), [0.5] * 3 + [0.02] * 3, rtol=0.03)
    given = np.array([errors.delivered(k, thrust, 2.0) for k in range(len(drawn))])
    size = np.linalg.norm(thrust)
    along = given @ thrust / size**2
    across = given - np.outer(along, thrust)
    assert np.linalg.norm(given, axis=1).std() == pytest.approx(0.1 * size, rel=0.03)
    # Two independent turns of 0.05 rad each.
    assert np.linalg.norm(across, axis=1).mean() == pytest.approx(
        0.05 * math.sqrt(math.pi / 2.0) * size, rel=0.03
    )
    assert np.abs(across.mean(axis=0)).max() < 0.002 * size * 3.0
    kept = Drawn(truth_of(minimum_impulse=0.3), np.empty((0, 9)))
    assert kept.delivered(0, thrust, 2.0).tolist() == [0.0, 0.0, 0.0]
    assert kept.delivered(0, thrust, 3.0).tolist() == thrust.tolist()


def test_a_push_from_outside_moves_the_chaser_and_costs_nothing() -> None:
    class Wind(Exact):
        def push(self, k: int, state: Floats, thrust: Floats) -> Floats:
            return -thrust

    plant = Plant(DoubleIntegrator(), Spin(0.0))
    still, blown = (fly(plant, [], Damper(0.1), START, 5, 2.0, errors) for errors in (Exact(), Wind()))
    assert blown.delta_v[0] > still.delta_v[0] > 0.0
    np.testing.assert_allclose(blown.paths[0].states[-1, 3:], START[3:], atol=1e-12)


def test_impulses_change_the_velocity_at_once_and_are_written_down() -> None:
    kick, plant = np.array([0.1, -0.2, 0.3]), Plant(TwoBody(Orbit.of(1.1e-3)), Spin(0.0))
    commands = [Command(np.zeros(3)), Command(np.zeros(3), impulse=kick), Command(np.zeros(3))]
    path = fly(plant, [], Given(commands), START, 3, 2.0).paths[0]
    near = fly(Plant(Cwh(1.1e-3), Spin(0.0)), [], Given(commands), START, 3, 2.0)
    np.testing.assert_allclose(path.impulses, [[0.0] * 3, kick, [0.0] * 3])
    np.testing.assert_allclose(path.states[2, 3:] - path.states[1, 3:], kick, atol=0.01)
    np.testing.assert_allclose(path.states, near.paths[0].states, atol=1e-5)
    assert near.delta_v[0] == pytest.approx(np.linalg.norm(kick))
    assert near.peak[0] == 0.0
    assert len(fly(plant, [], Given(commands), START, 1, 2.0).paths[0].impulses) == 0
    weak = Drawn(truth_of(minimum_impulse=0.5), np.empty((0, 9)))
    assert fly(plant, [], Given(commands), START, 3, 2.0, weak).delta_v[0] == 0.0
