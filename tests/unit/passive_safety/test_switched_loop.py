"""The compiled and the closed-form flights of the switched rendezvous against the loop, in SI and step by step."""

import numpy as np
import pytest

from safestart.attitude.spin import Spin
from safestart.control.switched_lqr import SwitchedLqr
from safestart.dynamics.cwh import Cwh
from safestart.errors import InvalidInput
from safestart.model.scenario import Floats
from safestart.passive_safety.flights.rk8_flights import simulate
from safestart.passive_safety.flights.simulate import active, crossing_times
from safestart.passive_safety.model import MASS, PUBLISHED, Dynamics, Mode, coefficients, gain
from safestart.passive_safety.switching_guard import depth
from safestart.simulation.loop import fly
from safestart.simulation.plant import Plant
from safestart.simulation.record import Path

MINUTE = 60.0
PLANT = Plant(Cwh(float(coefficients(Dynamics.LINEAR)[1]) / 2.0 / MINUTE), Spin(0.0))
# The switch, the transient after it and the drift are all flown.
START, ABORT, END = np.array([-130.0, -60.0, 0.4, 0.1]), 15.0, 20.0


def in_si(k: Floats) -> Floats:
    """K / m in 1/min^2 and 1/min, to 1/s^2 and 1/s."""
    return k / MASS / np.array([MINUTE**2, MINUTE**2, MINUTE, MINUTE])


def slowly(dt: float) -> Path:
    far, near = (in_si(gain(PUBLISHED.motion(mode))) for mode in (Mode.FAR, Mode.NEAR))
    controller = SwitchedLqr(far, near, lambda p: bool(depth(PUBLISHED.guard, p) < 0.0), dt, ABORT * MINUTE)
    start = np.array([*START[:2], 0.0, *START[2:] / MINUTE, 0.0])
    return fly(PLANT, [], controller, start, round(END * MINUTE / dt), dt).paths[0]


def test_flights_in_minutes_are_the_loop_s_in_seconds() -> None:
    """A held command lags its law by half an interval: the difference falls with dt, and vanishes when extrapolated."""
    looks = np.array([3.0, 10.0, 14.0, ABORT, 18.0, END])
    states, entries = simulate(PUBLISHED, START[None], np.array([ABORT]), looks[None])
    crossing = crossing_times(PUBLISHED, START[None], END)
    assert 1.0 < entries[0] < 15.0
    assert crossing[0] == pytest.approx(entries[0], abs=1e-6)
    powered = looks <= ABORT
    closed = active(PUBLISHED, START, crossing, looks[powered])
    np.testing.assert_allclose(states[0, powered], closed, atol=1e-5)

    coarse, fine = slowly(0.5), slowly(0.25)
    seen = []
    for path, dt in ((coarse, 0.5), (fine, 0.25)):
        rows = np.round(looks * MINUTE / dt).astype(int)
        seen.append(path.states[rows][:, [0, 1, 3, 4]] * [1.0, 1.0, MINUTE, MINUTE])
    off = [np.abs(one - states[0]).max(axis=0) for one in seen]
    assert (off[1] < 0.6 * off[0]).all()
    # The switch falls on the start of an interval, which does not extrapolate.
    np.testing.assert_allclose(2.0 * seen[1] - seen[0], states[0], atol=2e-3)
    labels = [command.label for command in fine.commands]
    assert labels.index("near") * 0.25 / MINUTE == pytest.approx(entries[0], abs=0.02)
    assert labels.index("passive") * 0.25 == ABORT * MINUTE
    assert (fine.thrust[labels.index("passive") :] == 0.0).all()


def test_gains_of_another_shape_are_refused() -> None:
    with pytest.raises(InvalidInput, match="near"):
        SwitchedLqr(np.zeros((2, 4)), np.zeros((2, 6)), lambda p: False, 1.0)
