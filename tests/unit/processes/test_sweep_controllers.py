"""A controller that is new to the sweep flies within the chaser's thrust, under its own name."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safestart.control.controller import Command
from safestart.errors import InvalidInput
from safestart.model.scenario import Floats, Scenario
from safestart.processes.registry import process
from safestart.processes.sweep.cases import cases_of
from safestart.processes.sweep.controllers import CONTROLLERS, Offered
from safestart.processes.sweep.fleet import fly_all
from safestart.processes.sweep.inputs import SweepInputs


class Strong:
    """Fifty times the thrust that there is, or none at all."""

    def __init__(self, thrust: float) -> None:
        self._thrust = thrust

    def begin(self, state: Floats) -> None:
        """Nothing to forget."""

    def command(self, k: int, state: Floats) -> Command:
        return Command(np.array([0.0, self._thrust, 0.0]))


def strong(_: SweepInputs, scenario: Scenario, __: float, ___: int, ____: int) -> Strong:
    return Strong(50.0 * scenario.chaser.max_acceleration)


def broken(*_: object) -> Strong:
    return Strong(math.nan)


@pytest.fixture
def offered(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("strong", "broken"):
        monkeypatch.setitem(CONTROLLERS, name, Offered(name, name, "a test's", f"{__name__}:{name}"))


def flown(name: str) -> Floats:
    asked = SweepInputs(omega_t_deg_s=[3.0], a_max_m_s2=[0.1], r0_m=[20.0], cases_per_cell=4, horizon_s=20)
    parts = process("sweep").sharding.parts(asked)
    groups = [cases for part in parts for cases in cases_of(asked, part["pieces"])]
    return np.concatenate([fly_all(asked, name, cases, lambda _: None).delta_v for cases in groups])


@pytest.mark.usefixtures("offered")
def test_it_flies_no_more_than_the_thrust_limit() -> None:
    delta_v = flown("strong")
    assert (delta_v <= 0.1 * 20.0 * (1.0 + 1e-12)).all()
    assert delta_v.max() > 0.0


@pytest.mark.usefixtures("offered")
def test_a_command_that_is_no_number_is_refused() -> None:
    with pytest.raises(InvalidInput, match=r"thrust: required shape \(3,\), finite"):
        flown("broken")


def test_its_interval_divides_that_of_the_sweep() -> None:
    assert Offered("fine", "fine", "a test's", "nothing:at_all", dt=0.1).dt == 0.1
    for dt in (0.7, 0.0, -1.0, 4.0, math.nan):
        with pytest.raises(InvalidInput, match="dt of mine: required an interval that divides 2 s"):
            Offered("mine", "mine", "a test's", "nothing:at_all", dt=dt)
