"""Body-frame transforms: inverses, the transport term against finite differences."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from safestart.attitude.body_frame import body_to_lvlh, lvlh_to_body, rotation, transport

rates = st.floats(0.0, 1.0)
times = st.floats(0.0, 100.0)
vectors = st.lists(st.floats(-200.0, 200.0), min_size=3, max_size=3).map(np.array)


@given(rates, times, vectors, vectors)
def test_round_trip(rate: float, time: float, position: np.ndarray, velocity: np.ndarray) -> None:
    p, v = lvlh_to_body(*body_to_lvlh(position, velocity, rate, time), rate, time)
    np.testing.assert_allclose(p, position, atol=1e-10)
    np.testing.assert_allclose(v, velocity, atol=1e-9)


@given(rates, times, vectors, vectors)
def test_velocity_is_the_derivative_of_position(
    rate: float, time: float, position: np.ndarray, velocity: np.ndarray
) -> None:
    """Central difference of a body-frame straight line seen from LVLH."""
    h = 1e-4
    ahead, _ = body_to_lvlh(position + h * velocity, velocity, rate, time + h)
    behind, _ = body_to_lvlh(position - h * velocity, velocity, rate, time - h)
    _, seen = body_to_lvlh(position, velocity, rate, time)
    np.testing.assert_allclose((ahead - behind) / (2 * h), seen, atol=2e-4)


def test_planar_and_spatial_agree_and_body_rest_corotates() -> None:
    position = np.array([3.0, 40.0])
    p, v = body_to_lvlh(position, np.zeros(2), 0.05, 12.0)
    np.testing.assert_allclose(p, rotation(0.6) @ position)
    np.testing.assert_allclose(np.linalg.norm(v), 0.05 * np.linalg.norm(position))
    spatial, _ = body_to_lvlh(np.array([3.0, 40.0, 7.0]), np.zeros(3), 0.05, 12.0)
    np.testing.assert_allclose(spatial, [*p, 7.0])
    np.testing.assert_array_equal(transport(np.array([1.0, 0.0]), 2.0), [0.0, 2.0])
