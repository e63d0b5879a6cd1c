"""The least tightening: chosen on some flights, confirmed on others, given up as soon as it cannot be shown."""

import numpy as np
import pytest

import safestart.hopping_safety.tightening as tightening
from safestart.errors import InvalidInput
from safestart.hopping_flights.fly import HoppingFlight, World
from safestart.hopping_safety.tightening import flown, least_tightening


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Flights that breach where a number drawn is above kappa; the list holds the kappas flown."""
    kappas: list[float] = []

    def fly(world: World, rng: np.random.Generator, steer: object) -> HoppingFlight:
        kappas.append(world.kappa)
        drawn = rng.uniform(0.0, 3.0)
        if drawn > 2.99:
            raise InvalidInput("past the fold")
        near = 10.0 if drawn > world.kappa else 90.0
        closest = np.array([90.0, near, 5.0])
        return HoppingFlight(np.ones((3, 3)), closest, np.zeros((3, 6)), np.zeros(3), 100.0, True)

    monkeypatch.setattr(tightening, "fly", fly)
    return kappas


def numbers(stream: int):
    return lambda run: np.random.default_rng([stream, run])


def test_the_first_that_both_sets_show(made_up: list[float]) -> None:
    found = least_tightening(World(), [1.0, 2.0, 2.97, 2.999], numbers(0), numbers(1), 400, 0.05)
    assert found is not None
    kappa, flights = found
    assert kappa == 2.97
    assert flights.runs == 400
    assert flights.breaches + flights.lost == sum(numbers(1)(k).uniform(0.0, 3.0) > 2.97 for k in range(400))
    assert flights.shown <= 0.05
    assert made_up.count(1.0) < 40, "given up early"
    assert made_up.count(2.97) == 800


def test_a_lucky_set_is_not_confirmed(made_up: list[float]) -> None:
    def lucky(run: int) -> np.random.Generator:
        return np.random.default_rng([7, 0])

    assert lucky(0).uniform(0.0, 3.0) < 2.0
    assert least_tightening(World(), [2.0], lucky, numbers(1), 100, 0.05) is None


def test_lost_runs_count_as_breaches(made_up: list[float]) -> None:
    found = flown(World(kappa=2.995), numbers(2), 2000)
    assert found is not None
    drawn = np.array([numbers(2)(k).uniform(0.0, 3.0) for k in range(2000)])
    assert found.lost == (drawn > 2.99).sum() > 0
    assert found.breaches == 0
    assert found.shown > found.lost / 2000
    assert flown(World(kappa=2.995), numbers(2), 2000, most=0) is None
