"""CWH closed forms against the matrix exponential, the semigroup law and the double integrator."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from safestart.dynamics import cwh
from safestart.errors import InvalidInput

motions = st.one_of(st.just(0.0), st.floats(1e-12, 1.3e-3), st.floats(1e-6, 1.2e-3))
times = st.floats(1e-3, 6000.0)


def _exponential(n: float, tau: float) -> tuple[np.ndarray, np.ndarray]:
    augmented = np.zeros((9, 9))
    augmented[:6, :6] = cwh.system_matrix(n)
    augmented[3:6, 6:] = np.eye(3)
    both = expm(augmented * tau)
    return both[:6, :6], both[:6, 6:]


def _error(ours: np.ndarray, other: np.ndarray) -> float:
    return float(np.abs(ours - other).max() / max(1.0, np.abs(other).max()))


@given(motions, times)
def test_equals_the_matrix_exponential(n: float, tau: float) -> None:
    phi, bd = _exponential(n, tau)
    assert _error(cwh.transition_matrix(n, tau), phi) < 1e-12
    assert _error(cwh.input_matrix(n, tau), bd) < 1e-12


@pytest.mark.parametrize("phase", [0.0, 1e-300, 1e-12, 1e-6, 0.4999999, 0.5000001, 3.0, 12.0])
def test_entries_lose_nothing_at_small_phase(phase: float) -> None:
    """Entry by entry and relative: the series and the direct form meet at the switch."""
    tau = 40.0
    phi, bd = _exponential(phase / tau, tau)
    np.testing.assert_allclose(cwh.transition_matrix(phase / tau, tau), phi, rtol=2e-11, atol=1e-13)
    np.testing.assert_allclose(cwh.input_matrix(phase / tau, tau), bd, rtol=2e-11, atol=1e-11)


@given(motions, st.floats(1.0, 500.0), st.floats(1.0, 500.0))
def test_semigroup_and_inverse(n: float, a: float, b: float) -> None:
    whole = cwh.transition_matrix(n, a + b)
    assert _error(cwh.transition_matrix(n, b) @ cwh.transition_matrix(n, a), whole) < 1e-12
    back = cwh.transition_matrix(n, -a) @ cwh.transition_matrix(n, a)
    assert _error(back, np.eye(6)) < 1e-10
    held = cwh.transition_matrix(n, b) @ cwh.input_matrix(n, a) + cwh.input_matrix(n, b)
    assert _error(held, cwh.input_matrix(n, a + b)) < 1e-12


def test_double_integrator_is_exact() -> None:
    tau = 7.0
    phi = cwh.transition_matrix(0.0, tau)
    assert np.array_equal(phi[:3, 3:], tau * np.eye(3))
    assert np.array_equal(cwh.input_matrix(0.0, tau)[:3], 0.5 * tau**2 * np.eye(3))


def test_planar_is_the_block_of_the_spatial() -> None:
    state = np.array([3.0, -4.0, 0.0, 0.1, 0.2, 0.0])
    flown = cwh.transition_matrix(1.1e-3, 60.0) @ state
    planar = cwh.planar_transition(1.1e-3, 60.0) @ state[[0, 1, 3, 4]]
    np.testing.assert_allclose(planar, flown[[0, 1, 3, 4]], rtol=1e-15)
    np.testing.assert_array_equal(
        cwh.planar_input(1.1e-3, 60.0), cwh.input_matrix(1.1e-3, 60.0)[[0, 1, 3, 4], :2]
    )


@pytest.mark.parametrize(("n", "tau"), [(-1e-3, 1.0), (float("nan"), 1.0), (1e-3, float("inf"))])
def test_bad_input_is_refused(n: float, tau: float) -> None:
    with pytest.raises(InvalidInput):
        cwh.transition_matrix(n, tau)
    with pytest.raises(InvalidInput):
        cwh.input_matrix(n, tau)


@pytest.mark.parametrize("n", [0.0, 1.1e-3, 1.3e-3])
def test_many_intervals_have_the_bits_of_each(n: float) -> None:
    """Short ones, by series, and long ones, beyond a phase of 0.5, together; backwards, too."""
    begin = np.array([0.0, 3.0, 10.0, 0.1, 100.0, 7.0])
    end = np.array([0.0, 3.7, 1610.0, 0.3, 20.0, 7.0 + 1e-9])
    motion = cwh.Cwh(n)
    phi, held = motion.moves(begin, end)
    for k, (t0, t1) in enumerate(zip(begin.tolist(), end.tolist(), strict=True)):
        assert phi[k].tobytes() == motion.transition(t0, t1).tobytes()
        assert held[k].tobytes() == motion.held(t0, t1).tobytes()
    empty = motion.moves(np.zeros(0), np.zeros(0))
    assert [one.shape for one in empty] == [(0, 6, 6), (0, 6, 3)]


def test_many_intervals_refuse_a_time_that_is_not_finite() -> None:
    with pytest.raises(InvalidInput):
        cwh.Cwh(1e-3).moves(np.zeros(2), np.array([1.0, np.nan]))
