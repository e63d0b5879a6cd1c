"""The least value of a cubic between two samples: its array form and its compiled form beside dense sampling."""

import numpy as np
import pytest

from safestart.constraints.cubic import dips
from safestart.constraints.dip import dip

PLACES = np.linspace(0.0, 1.0, 4001)


def drawn() -> np.ndarray:
    """Left, right, begin, end: any cubics, some with slopes of 0 or of rounding's size, which starts at rest have."""
    rng = np.random.default_rng(4)
    given = rng.normal(size=(4000, 4)) * 10.0 ** rng.uniform(-3.0, 1.0, (4000, 1))
    given[:1000, 2] = 0.0
    given[1000:1500, 2] *= 1e-18
    given[1500:2000, 3] = 0.0
    given[2000:2200, 1] = given[2000:2200, 0]
    return given


def by_samples(left: float, right: float, begin: float, end: float) -> float:
    rise = right - left
    square, bend = 3.0 * rise - 2.0 * begin - end, begin + end - 2.0 * rise
    return float((left + PLACES * (begin + PLACES * (square + PLACES * bend))).min())


def test_no_sample_lies_below() -> None:
    given = drawn()
    low, at = dips(given[:, None, :2].swapaxes(1, 2), given[:, None, 2:].swapaxes(1, 2))
    for row, least, place in zip(given, low[:, 0, 0], at[:, 0, 0], strict=True):
        true, size = by_samples(*row), np.abs(row).max()
        assert true - 1e-6 * size <= least <= true + 1e-14 * size
        assert 0.0 <= place <= 1.0
        ours = dip(*row)
        assert ours[0] == pytest.approx(least, abs=1e-15 * size)


@pytest.mark.parametrize("begin", [0.0, -0.0, 1e-20, -1e-20])
def test_a_minimum_behind_a_level_beginning(begin: float) -> None:
    """t^2 (t - 3/4) falls to -1/16 at 1/2 and is back above 0 at 1."""
    low, at = dip(0.0, 0.25, begin, 1.5)
    assert (low, at) == (pytest.approx(-0.0625), pytest.approx(0.5))
