"""A steady spin about any axis: a rotation that turns as its angular velocity says."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from safestart.attitude.attitude import to_body, to_lvlh
from safestart.attitude.body_frame import body_to_lvlh, lvlh_to_body
from safestart.attitude.spin import Spin, spin_of
from safestart.errors import InvalidInput
from safestart.model.scenario import Scenario

rates = st.floats(-0.5, 0.5)
phases = st.floats(-7.0, 7.0)
axes = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda a: math.hypot(*a) > 0.1)
TIMES = np.array([0.0, 3.0, 41.5])


@given(rates, axes, phases)
def test_rotation_is_the_inverse_turn_about_the_axis(rate: float, axis: tuple, phase: float) -> None:
    spin = Spin(rate, axis, phase)
    for time, turn in zip(TIMES, spin.rotation(TIMES), strict=True):
        body_to_inertial = Rotation.from_rotvec((phase + rate * time) * np.array(spin.axis)).as_matrix()
        np.testing.assert_allclose(turn, body_to_inertial.T, atol=1e-12)


@given(rates, axes, phases)
def test_rotation_turns_at_the_angular_velocity(rate: float, axis: tuple, phase: float) -> None:
    """R' = -[omega x] R, omega in body axes; never faster than the bound."""
    spin, h = Spin(rate, axis, phase), 1e-4
    change = (spin.rotation(TIMES + h) - spin.rotation(TIMES - h)) / (2.0 * h)
    for turn, rise, omega in zip(spin.rotation(TIMES), change, spin.angular_velocity(TIMES), strict=True):
        np.testing.assert_allclose(rise, -np.cross(omega, turn, axisb=0, axisc=0), atol=1e-8)
        assert math.hypot(*omega) <= spin.rate_bounds()[0] * (1.0 + 1e-12)


@given(rates, axes, phases, st.integers(0, 1000))
def test_states_go_to_the_body_and_back(rate: float, axis: tuple, phase: float, seed: int) -> None:
    spin = Spin(rate, axis, phase)
    states = np.random.default_rng(seed).normal(size=(3, 6)) * 100.0
    body = to_body(spin, TIMES, states)
    np.testing.assert_allclose(to_lvlh(spin, TIMES, body), states, atol=1e-10)
    np.testing.assert_allclose(
        np.linalg.norm(body[:, :3], axis=1), np.linalg.norm(states[:, :3], axis=1), atol=1e-10
    )


def test_about_z_it_is_the_paper_s_frame_in_every_bit() -> None:
    spin = spin_of(Scenario.of(3.0, 0.1).target)
    assert spin.planar
    angle = spin.rate * TIMES
    turn = spin.rotation(TIMES)
    np.testing.assert_array_equal(turn[:, 0, 0], np.cos(angle))
    np.testing.assert_array_equal(turn[:, 0, 1], np.sin(angle))
    np.testing.assert_array_equal(turn[:, 1, 0], -np.sin(angle))
    np.testing.assert_array_equal(turn[:, 2], [[0.0, 0.0, 1.0]] * 3)
    states = np.random.default_rng(0).normal(size=(3, 6))
    for time, state, seen in zip(TIMES, states, to_body(spin, TIMES, states), strict=True):
        p, v = lvlh_to_body(state[:3], state[3:], spin.rate, time)
        np.testing.assert_allclose(seen, [*p, *v], atol=1e-14)
        np.testing.assert_allclose(np.concatenate(body_to_lvlh(p, v, spin.rate, time)), state, atol=1e-14)


@pytest.mark.parametrize(
    "wrong",
    [{"rate": math.nan}, {"axis": (0.0, 0.0, 0.0)}, {"axis": (math.inf, 0.0, 1.0)}, {"phase": math.inf}],
)
def test_bad_numbers_raise(wrong: dict) -> None:
    with pytest.raises(InvalidInput, match=next(iter(wrong))):
        Spin(**({"rate": 0.1} | wrong))
