"""Flights to rest at the port leave one another alone."""

import numpy as np
import pytest

from safestart.attitude.spin import Spin
from safestart.control.tracking_mpc.controller import Program
from safestart.control.tracking_mpc.tuning import DockingCorridor, Tuning
from safestart.tracking.take import Approach, take


@pytest.fixture
def approach():
    tuning = Tuning(0.2, input_limit="ball")
    return Approach(0.001, 2.0, DockingCorridor(), Spin(0.05), tuning, 60, 10, 0.5, 0.05)


def test_a_flight_does_not_touch_another_one(approach, monkeypatch):
    """Two threads may fly the same approach: here the second flies between the first one's assembly and solution."""
    near, far = np.array([0.3, 8.0, 0.2, 0.0, 0.0, 0.0]), np.array([-2.0, 14.0, 1.0, 0.0, 0.0, 0.0])
    alone, assemble, inside = take(approach, near, lambda _: 1.0), Program.assemble, []

    def interrupted(program, attitudes):
        assemble(program, attitudes)
        if not inside:
            inside.append(program)
            take(approach, far, lambda _: 1.0)

    monkeypatch.setattr(Program, "assemble", interrupted)
    flown = take(approach, near, lambda _: 1.0)
    assert inside
    assert alone.arrived is not None
    np.testing.assert_array_equal(flown.thrust, alone.thrust)
