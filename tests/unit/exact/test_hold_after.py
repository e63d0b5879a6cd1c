"""The hold after `synchronize`, flown in the product's own loop: to the end by the thrust history, then by the LQR."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safestart.attitude.spin import Spin
from safestart.constraints.corridor import corridor_of
from safestart.control.hold.arrive_and_hold import ArriveAndHold
from safestart.control.hold.hold_lqr import Design, HoldLqr
from safestart.control.hold.turning_reference import TurningReference
from safestart.dynamics.cwh import Cwh, planar_input, planar_transition
from safestart.exact.answer import Held
from safestart.exact.decide import decide
from safestart.exact.hold_after import with_hold
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Floats, Scenario
from safestart.simulation.loop import fly
from safestart.simulation.plant import Plant

QUESTION = Question(Scenario.of(2.0, 0.05), 2.0, 60, 2, Goal(hold=(0.0, 2.0)))
START = np.array([5.0, 30.0, 0.0, 0.0])


def pilot_of(question: Question, held: Held, phase: float) -> HoldLqr:
    target, dt = question.scenario.target, question.dt
    closed = planar_transition(target.mean_motion, dt) + planar_input(target.mean_motion, dt) @ held.gain
    reference = TurningReference.of(held.point, target.tumble_rate, target.mean_motion, dt)
    most = question.scenario.chaser.max_acceleration
    return HoldLqr(Design(-held.gain, closed, held.cost), reference, phase, most)


@pytest.fixture(scope="module")
def held() -> tuple[Floats, Held]:
    answer = with_hold(QUESTION, START, decide(QUESTION, START))
    assert answer.held is not None
    assert answer.thrust is not None
    return answer.thrust, answer.held


def test_the_whole_flight_is_one(held: tuple[Floats, Held]) -> None:
    thrust, found = held
    target = QUESTION.scenario.target
    plant = Plant(Cwh(target.mean_motion), Spin(target.tumble_rate))
    start = np.array([*START[:2], 0.0, *START[2:], 0.0])
    pilot = ArriveAndHold(thrust, pilot_of(QUESTION, found, 0.0))
    corridor = corridor_of(QUESTION.scenario.corridor)
    record = fly(plant, [corridor], pilot, start, len(thrust) + 300, QUESTION.dt)
    # The margin of a flight is over all its time.
    assert record.margin[0] > 0.2
    assert record.peak[0] <= QUESTION.scenario.chaser.max_acceleration
    states = record.paths[0].states[:, :2]
    angle = target.tumble_rate * QUESTION.dt * (len(states) - 1)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    assert turn @ states[-1] == pytest.approx(found.point, abs=1e-6)


def test_flights_from_the_boundary_in_the_loop(held: tuple[Floats, Held]) -> None:
    """From a boundary state at any angle of the body, worst ones among them."""
    least, most = boundary(QUESTION, held[1], 40, 1)
    assert least >= held[1].margin
    assert most <= QUESTION.scenario.chaser.max_acceleration


def boundary(question: Question, held: Held, times: int, seed: int) -> tuple[float, float]:
    """Least margin (m) and most thrust (m/s^2) of so many flights."""
    rng = np.random.default_rng(seed)
    target, corridor = question.scenario.target, corridor_of(question.scenario.corridor)
    root = math.sqrt(held.level) * np.linalg.inv(np.linalg.cholesky(held.cost)).T
    least, most = math.inf, 0.0
    for k in range(times):
        # A direction at random, or where the error reaches farthest along one.
        way = rng.normal(size=4) if k % 2 else root.T @ np.r_[rng.normal(size=2), 0.0, 0.0]
        phase = float(rng.uniform(0.0, 2.0 * math.pi))
        pilot = pilot_of(question, held, phase)
        reference = TurningReference.of(held.point, target.tumble_rate, target.mean_motion, question.dt)
        x, y, vx, vy = (reference.at(phase)[0] + root @ (way / np.linalg.norm(way))).tolist()
        plant = Plant(Cwh(target.mean_motion), Spin(target.tumble_rate, phase=phase))
        record = fly(plant, [corridor], pilot, np.array([x, y, 0.0, vx, vy, 0.0]), 40, question.dt)
        least, most = min(least, float(record.margin[0])), max(most, float(record.peak[0]))
    return least, most
