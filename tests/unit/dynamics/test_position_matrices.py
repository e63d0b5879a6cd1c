"""CWH as a motion: many durations at once against one at a time, and what makes a motion steady."""

import numpy as np
import pytest

from safestart.dynamics.cwh import Cwh, input_matrix, transition_matrix
from safestart.dynamics.motion import SteadyMotion
from safestart.errors import InvalidInput
from tests.unit.optim.motions import TwoOrbits


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize(
    ("mean_motion", "longest"),
    [(0.0, 60.0), (1.1e-3, 2.0), (1.1e-3, 28.0), (1.1e-3, 400.0), (1.3e-3, 384.6), (1.1e-3, 3600.0)],
)
def test_many_durations_are_the_single_ones(mean_motion: float, longest: float, d: int) -> None:
    """Short series, long series (phase up to 0.5) and the closed form beyond."""
    tau = np.r_[0.0, np.linspace(0.0, longest, 7)]
    free, held = Cwh(mean_motion).positions(tau, d)
    keep = np.r_[0:d, 3 : 3 + d]
    for k, t in enumerate(tau.tolist()):
        np.testing.assert_allclose(
            free[k], transition_matrix(mean_motion, t)[:d, keep], rtol=1e-14, atol=1e-13
        )
        np.testing.assert_allclose(held[k], input_matrix(mean_motion, t)[:d, :d], rtol=1e-13, atol=1e-12)


def test_no_duration_at_all() -> None:
    free, held = Cwh(1.1e-3).positions(np.empty(0), 3)
    assert (free.shape, held.shape) == ((0, 3, 6), (0, 3, 3))


def test_only_the_difference_of_times_counts() -> None:
    motion = Cwh(1.1e-3)
    assert isinstance(motion, SteadyMotion)
    np.testing.assert_array_equal(motion.transition(100.0, 140.0), transition_matrix(1.1e-3, 40.0))
    np.testing.assert_array_equal(motion.held(100.0, 140.0), input_matrix(1.1e-3, 40.0))
    assert (motion, hash(motion)) == (Cwh(1.1e-3), hash(Cwh(1.1e-3)))
    assert not isinstance(TwoOrbits(), SteadyMotion)


@pytest.mark.parametrize("mean_motion", [-1e-3, float("nan"), 1.0])
def test_bad_motions(mean_motion: float) -> None:
    with pytest.raises(InvalidInput):
        Cwh(mean_motion)
