"""Relative motion on elliptic orbits against an integrator of the linear equations, CWH, and two bodies."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from safestart.dynamics.cwh import Cwh
from safestart.dynamics.yamanaka_ankersen import YamanakaAnkersen
from safestart.model.orbit import MU, KeplerOrbit


def integrated(orbit: KeplerOrbit, semi_major_axis: float, t0: float, t1: float) -> tuple:
    """Phi and the held input from t0 to t1, with r and nu' of the orbit's own equations."""
    e = orbit.eccentricity
    p = semi_major_axis * (1.0 - e * e)
    h = math.sqrt(MU * p)

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        r = p / (1.0 + e * math.cos(y[0]))
        w, fall, g = h / r**2, MU / h * e * math.sin(y[0]), MU / r**3
        change, a = -2.0 * w * fall / r, np.zeros((6, 6))
        a[:3, 3:] = np.eye(3)
        a[3, 0], a[3, 1], a[3, 4] = w * w + 2.0 * g, change, 2.0 * w
        a[4, 0], a[4, 1], a[4, 3], a[5, 2] = -change, w * w - g, -2.0 * w, -g
        moved = a @ y[1:].reshape(6, 9)
        moved[3:, 6:] += np.eye(3)
        return np.concatenate([[w], moved.ravel()])

    begin = orbit.true_anomaly + float(orbit.turned(np.array([t0]))[0])
    first = np.concatenate([[begin], np.eye(6, 9).ravel()])
    found = solve_ivp(rates, (t0, t1), first, "DOP853", rtol=1e-13, atol=1e-15).y[1:, -1].reshape(6, 9)
    return found[:, :6], found[:, 6:]


@pytest.mark.parametrize("eccentricity", [0.0, 0.1, 0.5, 0.8])
@pytest.mark.parametrize("anomaly", [0.0, -2.0, 3.1])
@pytest.mark.parametrize("span", [2.0, 60.0, 4000.0])
def test_equals_an_integrator(eccentricity: float, anomaly: float, span: float) -> None:
    orbit = KeplerOrbit.of(4.0e7, eccentricity, anomaly)
    motion, t0 = YamanakaAnkersen(orbit), 100.0
    phi, held = integrated(orbit, 4.0e7, t0, t0 + span)
    for found, expected in ((motion.transition(t0, t0 + span), phi), (motion.held(t0, t0 + span), held)):
        assert np.abs(found - expected).max() < 1e-11 * max(1.0, np.abs(expected).max())


@pytest.mark.parametrize("span", [0.5, 2.0, 600.0, -30.0])
def test_circular_is_cwh(span: float) -> None:
    motion, cwh = YamanakaAnkersen(KeplerOrbit(1.1e-3)), Cwh(1.1e-3)
    for found, expected in (
        (motion.transition(7.0, 7.0 + span), cwh.transition(0.0, span)),
        (motion.held(7.0, 7.0 + span), cwh.held(0.0, span)),
    ):
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-11 * max(1.0, np.abs(expected).max()))


def test_nearly_circular_is_nearly_cwh_and_no_orbit_is_straight() -> None:
    nearly = YamanakaAnkersen(KeplerOrbit(1.1e-3, 1e-9, 0.4)).transition(0.0, 60.0)
    np.testing.assert_allclose(nearly, Cwh(1.1e-3).transition(0.0, 60.0), atol=1e-8)
    free = YamanakaAnkersen(KeplerOrbit(0.0))
    np.testing.assert_array_equal(free.transition(0.0, 8.0), Cwh(0.0).transition(0.0, 8.0))
    np.testing.assert_array_equal(free.held(0.0, 8.0), Cwh(0.0).held(0.0, 8.0))


def test_intervals_join() -> None:
    """Across the border between series and closed form as well."""
    motion = YamanakaAnkersen(KeplerOrbit.of(2.6e7, 0.7, -0.1))
    whole, t = motion.transition(0.0, 700.0), 5.0
    np.testing.assert_allclose(motion.transition(t, 700.0) @ motion.transition(0.0, t), whole, rtol=1e-9)
    later = motion.transition(t, 700.0) @ motion.held(0.0, t) + motion.held(t, 700.0)
    np.testing.assert_allclose(later, motion.held(0.0, 700.0), rtol=1e-9, atol=1e-7)
