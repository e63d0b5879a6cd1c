"""The encounters in step against the slow loop, one flight at a time; the burns and the law against it as well."""

import numpy as np
import pytest

from safestart.attitude.spin import Spin
from safestart.collision_avoidance.encounters.adversary import Adversary, adversary
from safestart.collision_avoidance.encounters.clock import Clock
from safestart.collision_avoidance.encounters.encounter import fly
from safestart.collision_avoidance.encounters.escape import MODES
from safestart.collision_avoidance.encounters.escape import fly as escape
from safestart.collision_avoidance.encounters.observation import Observer
from safestart.collision_avoidance.encounters.pilots import PILOTS, pilot
from safestart.collision_avoidance.encounters.slot import Slot
from safestart.collision_avoidance.encounters.starts import near_boundary
from safestart.collision_avoidance.encounters.supervisor import Guards, Supervisor
from safestart.collision_avoidance.game import Game
from safestart.collision_avoidance.tube import solve_tube
from safestart.collision_avoidance.tube_settings import TubeSettings
from safestart.constraints.thrust import InputSet
from safestart.control.controller import Controller
from safestart.control.escape import Burn
from safestart.dynamics.cwh import Cwh
from safestart.model.scenario import Floats
from safestart.runtime.progress import Context
from safestart.simulation.loop import fly as fly_slowly
from safestart.simulation.noise import Exact
from safestart.simulation.plant import Plant
from safestart.simulation.record import Record
from tests.unit.simulation.parts import KeepOut

pytestmark = pytest.mark.slow

GAME = Game(0.0011, InputSet("box", (0.1, 0.1)), InputSet("box", (0.05, 0.05)), 100.0)
HORIZON = 60.0
CLOCK, SLOT = Clock(1.0, HORIZON), Slot()
BELOW = 1000.0
"""A ball of negative radius is never entered, so that every flight lasts; its distance is the separation and this."""
PLANT = Plant(Cwh(GAME.mean_motion), Spin(0.0))


@pytest.fixture(scope="module")
def observer() -> Observer:
    return Observer(GAME, solve_tube(GAME, HORIZON, TubeSettings(shape=(15, 9), half=(450.0, 6.0), kept=5)))


@pytest.fixture(scope="module")
def starts(observer: Observer) -> Floats:
    return near_boundary(observer, 6, 20.0, 1, Context())


class Opposed(Exact):
    """The other player as a push from outside."""

    def __init__(self, observer: Observer, clock: Clock, opponent: Adversary) -> None:
        self.observer, self.clock, self.opponent = observer, clock, opponent

    def push(self, k: int, state: Floats, thrust: Floats) -> Floats:
        to_go = self.clock.to_go(k, self.observer.tube.horizon_s)
        moment = self.observer.look(k, GAME.from_lvlh(state[None]), to_go)
        return GAME.thrust_to_lvlh(self.opponent(moment, GAME.thrust_from_lvlh(thrust[None]))[0])


def slowly(observer: Observer, controller: Controller, start: Floats, clock: Clock, name: str) -> Record:
    errors = Opposed(observer, clock, adversary(name, GAME, HORIZON, 1, 3, 10))
    return fly_slowly(PLANT, [KeepOut(-BELOW)], controller, start, clock.steps, clock.period_s, errors)


@pytest.mark.parametrize("name", PILOTS)
@pytest.mark.parametrize("other", ["worst", "mirror", "pursuit", "none"])
def test_encounters_in_step_are_those_of_the_slow_loop(
    observer: Observer, starts: Floats, name: str, other: str
) -> None:
    flier = pilot(name, observer, CLOCK, SLOT)
    opponent = adversary(other, GAME, HORIZON, len(starts), 3, 10)
    together = fly(observer, starts, flier, opponent, CLOCK, keep_paths=True)
    for row, start in enumerate(starts):
        alone = slowly(observer, flier, start, CLOCK, other)
        np.testing.assert_allclose(together.paths[row].states, alone.paths[0].states, atol=1e-7)
        np.testing.assert_allclose(together.paths[row].thrust, alone.paths[0].thrust, atol=1e-9)
        assert together.peak[row] == pytest.approx(alone.peak[0], abs=1e-9)
        # Channels of a box add up in a game; the loop takes the length. Separation in step is a bound from below.
        by_channel = np.abs(alone.paths[0].thrust).sum() * CLOCK.period_s
        assert together.delta_v[row] == pytest.approx(by_channel, abs=1e-8)
        separation = alone.margin[0] - BELOW
        # Where two paths all but meet, the distance has a kink that no cubic follows.
        if separation > 10.0:
            assert separation - 0.1 < together.margin[row] <= separation + 1e-6


def test_a_supervised_flight_is_that_of_the_slow_loop(observer: Observer) -> None:
    class One(Supervisor):
        """The supervisor of a single flight."""

        def begin(self, state: Floats) -> None:
            super().begin(state[None])

        def command(self, k: int, state: Floats):  # type: ignore[no-untyped-def]
            batch = super().command(k, state[None])
            return type(batch)(batch.thrust[0])

    clock = Clock(1.0, 400.0, receding=True)
    start = GAME.to_lvlh(np.array([420.0, 3.0, -5.5, 0.1]))
    guards = Guards(observer.tube.grid_error_m, 10.0)
    many, one = Supervisor(observer, SLOT, guards, clock), One(observer, SLOT, guards, clock)
    together = fly(
        observer, start[None], many, adversary("worst", GAME, HORIZON, 1, 3, 10), clock, keep_paths=True
    )
    alone = slowly(observer, one, start, clock, "worst")
    np.testing.assert_allclose(together.paths[0].states, alone.paths[0].states, atol=1e-5)
    assert (many.switches == one.switches).all()
    assert many.switches.sum() > 0


@pytest.mark.parametrize("mode", MODES, ids=[mode.name for mode in MODES])
def test_an_escape_is_a_burn_in_the_slow_loop(mode) -> None:  # type: ignore[no-untyped-def]
    start = GAME.to_lvlh(np.array([200.0, -30.0, 1.0, 0.5]))
    closed = escape(GAME, mode, start, 65.0, 3000.0)
    thrust = GAME.thrust_to_lvlh(GAME.control.extreme(np.array(mode.direction)))
    flown = fly_slowly(PLANT, [KeepOut(-BELOW)], Burn(thrust, 65.0, 5.0), start, 600, 5.0)
    np.testing.assert_allclose(closed.path.states, flown.paths[0].states[::2], atol=1e-6)
    assert flown.delta_v[0] == pytest.approx(6.5)
    assert 10.0 * np.linalg.norm(closed.path.thrust, axis=1).sum() == pytest.approx(6.5)
    assert closed.path.thrust[6] == pytest.approx(0.5 * thrust)
