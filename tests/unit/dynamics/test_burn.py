"""A burn that is off: size and angle are what was asked, and the compiled turn in the plane is the same turn."""

import math

import numpy as np
import pytest

from safestart.dynamics import burn_kernel
from safestart.dynamics.burn import frame, misdirected, scattered
from safestart.simulation.noise import Truth, delivered

BURN = np.array([0.03, -0.04, 0.12])


def test_the_frame_is_orthonormal_for_every_direction() -> None:
    for vector in (*np.eye(3), *np.random.default_rng(1).normal(size=(50, 3))):
        axes = np.array(frame(vector))
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
        assert axes[0] @ vector == pytest.approx(np.linalg.norm(vector))


@pytest.mark.parametrize(("angle", "share"), [(0.0, 1.0), (0.3, 0.9), (2.5, 1.2)])
def test_a_misdirected_burn_has_the_size_and_the_angle(angle: float, share: float) -> None:
    along, one, two = frame(BURN)
    aside = math.cos(0.7) * one + math.sin(0.7) * two
    found = misdirected(BURN, angle, aside, share)
    size = share * float(np.linalg.norm(BURN))
    assert np.linalg.norm(found) == pytest.approx(size, rel=1e-14)
    assert found @ along == pytest.approx(size * math.cos(angle), abs=1e-15)
    assert found @ aside == pytest.approx(size * math.sin(angle), abs=1e-15)


def test_a_scattered_burn_is_misdirected_by_what_was_drawn() -> None:
    drawn = np.array([1.5, -0.4, 2.0])
    found = scattered(BURN, 0.02, 0.05, drawn)
    assert np.linalg.norm(found) == pytest.approx(1.03 * np.linalg.norm(BURN), rel=1e-14)
    turned = math.acos(found @ BURN / np.linalg.norm(found) / np.linalg.norm(BURN))
    assert turned == pytest.approx(0.05 * math.hypot(-0.4, 2.0), rel=1e-9)
    assert scattered(np.zeros(3), 0.02, 0.05, drawn).tolist() == [0.0, 0.0, 0.0]
    np.testing.assert_allclose(scattered(BURN, 0.02, 0.05, np.zeros(3)), BURN, rtol=1e-15)


def test_the_compiled_scatter_is_the_same() -> None:
    random = np.random.default_rng(7)
    for burn in (*random.normal(size=(50, 3)), *np.eye(3), np.zeros(3)):
        for drawn in (random.normal(size=3), np.array([1.0, 0.0, 0.0])):
            slow = scattered(burn, 0.02, 0.05, drawn)
            np.testing.assert_allclose(
                burn_kernel.scattered(burn, 0.02, 0.05, drawn), slow, rtol=1e-13, atol=1e-15
            )


def test_the_compiled_turn_in_the_plane_is_the_same() -> None:
    random = np.random.default_rng(4)
    truth = Truth(magnitude_sigma=0.1, direction_sigma=0.4)
    for _ in range(100):
        (x, y), (size, turn) = random.normal(size=(2, 2))
        aside = np.array([-y, x, 0.0]) / math.hypot(x, y)
        slow = misdirected(np.array([x, y, 0.0]), 0.4 * turn, aside, 1.0 + 0.1 * size)
        np.testing.assert_allclose([*delivered(truth, x, y, size, turn), 0.0], slow, rtol=1e-13, atol=1e-15)
