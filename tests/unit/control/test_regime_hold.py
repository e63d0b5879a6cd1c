"""The three-regime controller's own hold: the linear loop is what it flies, and from its set it never leaves it."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest

from safestart.attitude.spin import Spin
from safestart.control.forecast import flight_plan
from safestart.control.gains import PAPER, TUNED, Gains
from safestart.control.hold.ellipsoid import ellipsoid, rooms_of
from safestart.control.hold.regime_hold import RegimeHold
from safestart.control.three_regimes import ThreeRegimes
from safestart.dynamics.cwh import Cwh
from safestart.errors import InvalidInput
from safestart.model.scenario import Floats, Scenario
from safestart.simulation.loop import fly
from safestart.simulation.plant import Plant
from safestart.simulation.record import Record

PLANE = [0, 1, 3, 4]


def loop_of(rate: float, most: float, gains: Gains, step: float = 2.0) -> RegimeHold:
    return RegimeHold.of(Scenario.of(rate, most), gains, step, 6, 1.0, 0.1)


def flown(
    rate: float, most: float, gains: Gains, error: Floats, first: int, steps: int, step: float = 2.0
) -> Record:
    """The controller with its filter, from an error at interval ``first``."""
    scenario, own = Scenario.of(rate, most), loop_of(rate, most, gains, step)
    angle = own.reference.rate * step * first
    x, y, vx, vy, *before = own.at(error, angle)
    pilot = ThreeRegimes(
        flight_plan(scenario, gains, step, first + steps), first=first, before=np.array(before)
    )
    plant = Plant(Cwh(scenario.target.mean_motion), Spin(scenario.target.tumble_rate, phase=angle))
    return fly(plant, [own.corridor], pilot, np.array([x, y, 0.0, vx, vy, 0.0]), steps, step)


def error_of(own: RegimeHold, record: Record, k: int, first: int) -> Floats:
    angle = own.reference.rate * own.reference.step * (first + k)
    path = record.paths[0]
    return np.concatenate([path.states[k][PLANE], path.commands[k - 1].thrust[:2]]) - own.at(
        np.zeros(6), angle
    )


def boundary(own: RegimeHold, level: float, number: int, rng: np.random.Generator) -> Floats:
    sphere = rng.normal(size=(number, 6))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    return np.asarray(math.sqrt(level) * sphere @ np.linalg.inv(np.linalg.cholesky(own.cost)))


@pytest.mark.parametrize(
    ("rate", "most", "gains", "step"),
    [
        (0.0, 0.1, TUNED, 2.0),
        (3.0, 0.1, TUNED, 2.0),
        (5.0, 0.05, TUNED, 2.0),
        (1.0, 0.01, TUNED, 2.0),
        (8.0, 0.1, TUNED, 1.0),
        (1.0, 0.02, PAPER, 2.0),
        (2.0, 0.1, replace(PAPER, speed_limit=0.2, disk_limit=0.3), 2.0),
    ],
)
def test_from_its_boundary_it_stays_and_moves_as_said(
    rate: float, most: float, gains: Gains, step: float
) -> None:
    own = loop_of(rate, most, gains, step)
    kept = ellipsoid(own)
    assert kept.level > 0.0
    rng = np.random.default_rng(3)
    for error in boundary(own, kept.level, 25, rng):
        first = int(rng.integers(100))
        record = flown(rate, most, gains, error, first, 30, step)
        assert all(command.label == "hold" and command.feasible for command in record.paths[0].commands)
        assert record.margin[0] >= 0.0
        assert record.peak[0] <= own.usable * (1.0 + 1e-12)
        cost = kept.level
        for k in (1, 2, 7, 30):
            found = error_of(own, record, k, first)
            assert found == pytest.approx(np.linalg.matrix_power(own.closed, k) @ error, abs=1e-9)
            assert found @ own.cost @ found < cost
            cost = float(found @ own.cost @ found)


@pytest.mark.parametrize(
    ("rate", "most", "gains", "limit"),
    [
        (1.0, 0.02, TUNED, "thrust"),
        (5.0, 0.05, TUNED, "switch_speed"),
        (3.0, 0.1, TUNED, "filter"),
        (0.0, 0.1, replace(TUNED, hold_band=0.1), "hold_band"),
        (0.0, 0.1, replace(TUNED, hold_clearance=0.2, corridor_margin=0.0), "filter"),
    ],
)
def test_a_little_beyond_something_gives(rate: float, most: float, gains: Gains, limit: str) -> None:
    """From the worst error of the limit that binds, 3 % larger, at some angle the loop is another one."""
    own = loop_of(rate, most, gains)
    kept = ellipsoid(own)
    assert kept.limited_by == limit
    left = [False, False]
    for k, size in enumerate((0.999, 1.03)):
        for first in (0, 14, 31, 47):
            for error in size * worst(own, kept.level, limit):
                record = flown(rate, most, gains, error, first, 1)
                command, plain = record.paths[0].commands[0], error_of(own, record, 1, first)
                same = np.abs(plain - own.closed @ error).max() < 1e-7
                left[k] |= not (command.label == "hold" and command.feasible and same)
    assert left == [False, True]


def worst(own: RegimeHold, level: float, limit: str) -> Floats:
    """Boundary errors that take most of the rooms of a limit: 8 directions of each row pair."""
    law, turn = own.law, np.array([[0.0, -1.0], [1.0, 0.0]])
    rows = {
        "thrust": [own.rows],
        "switch_speed": [np.hstack([-law.tumble_rate * turn, np.eye(2), np.zeros((2, 2))])],
        "filter": [own.moved(j * own.reference.step) for j in range(1, 7)],
        "hold_band": [np.eye(2, 6)],
    }[limit]
    out = []
    root = np.linalg.inv(np.linalg.cholesky(own.cost)).T
    for pair in rows:
        for angle in np.linspace(0.0, 2.0 * math.pi, 8, endpoint=False):
            way = root.T @ pair.T @ np.array([math.cos(angle), math.sin(angle)])
            out.append(math.sqrt(level) * root @ way / np.linalg.norm(way))
    return np.array(out)


def test_with_the_papers_weights_the_hold_is_unstable_from_2_82_degrees_a_second() -> None:
    """w_du = 2.0 at dt = 2 s: the previous command is old by the time the body has turned on."""
    calm, grown = loop_of(2.82, 0.1, PAPER), loop_of(2.83, 0.1, PAPER)
    assert calm.spectral_radius < 1.0 < grown.spectral_radius
    assert not grown.stable
    tuned = loop_of(11.29, 0.1, TUNED), loop_of(11.30, 0.1, TUNED)
    assert tuned[0].spectral_radius < 1.0 < tuned[1].spectral_radius
    for rate, ratio in ((2.6, (0.0, 0.3)), (3.1, (3.0, 100.0))):
        own = loop_of(rate, 0.1, PAPER)
        record = flown(rate, 0.1, PAPER, np.array([1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]), 0, 300)
        early, late = (np.linalg.norm(error_of(own, record, k, 0)[:2]) for k in (20, 300))
        assert ratio[0] < late / early < ratio[1]


def test_where_it_settles() -> None:
    own = loop_of(3.0, 0.1, TUNED)
    record = flown(3.0, 0.1, TUNED, np.zeros(6), 0, 60)
    place, radius = own.reference.between(0.0)
    for k in (1, 30, 60):
        x, y = record.paths[0].states[k][:2]
        seen = cmath.exp(-1j * own.reference.rate * 2.0 * k) * complex(x, y)
        assert abs(seen - complex(*place)) == pytest.approx(radius, abs=1e-9)
    # The filter gives 1.2 / 1.3 of the demand: it circles 11 mm from the hold point.
    assert math.hypot(place[0], place[1] - 2.0) == pytest.approx(0.011, abs=5e-4)


def test_a_place_that_asks_for_too_much_keeps_nothing() -> None:
    own = loop_of(8.0, 0.03, TUNED)
    assert own.stable
    kept = ellipsoid(own)
    assert kept.level == 0.0
    assert min(rooms_of(own), key=lambda room: room.room).room < 0.0


def test_a_target_that_turns_too_far_in_a_step_is_refused() -> None:
    with pytest.raises(InvalidInput, match="dt_s"):
        loop_of(30.0, 0.1, TUNED, 2.0)
