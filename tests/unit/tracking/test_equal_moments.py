"""Targets with two or three equal moments: the textbook's rocket body and the ball, in every order of the axes."""

import itertools
import math

import numpy as np
import pytest

from safestart.attitude.torque_free import TorqueFree
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.theta_radius import ball_radius, bracket, printed_radius
from safestart.control.tracking_mpc.tumble import Tumble
from tests.unit.tracking.envisat import MEAN_MOTION

MOMENTS = (
    (1000.0, 1000.0, 1500.0),
    (500.0, 1000.0, 1000.0),
    (1000.0, 1000.0, 2000.0),
    (1000.0, 1000.0, 1000.0001),
    (1000.0, 1000.0, 1000.0),
    (123.4, 123.4, 200.1),
)
SPINS = (
    (0.0, 0.0, 0.0),
    (0.0, 0.0, 0.05),
    (0.0, 0.0616, 0.0616),
    (0.03318287855087, 0.09862369269649, 0.0),
    (0.0, -0.02642841687456, -0.00651697680789),
    (0.042969639525912, 0.0, 0.06819283150093),
    (0.0321, 0.0457, -0.0123),
    (0.03, 0.07, 1e-9),
    (0.03, 0.07, 1e-170),
)
ORDERS = [order for moments in MOMENTS for order in sorted(set(itertools.permutations(moments)))]
TIMES = np.linspace(0.0, 300.0, 61)


@pytest.mark.parametrize("moments", ORDERS)
def test_motion_and_bounds(moments):
    inertia = np.diag(moments)
    for spin in SPINS:
        body = TorqueFree(tuple(map(tuple, inertia.tolist())), (1.0, 0.0, 0.0, 0.0), spin)
        frames, rates = body.rotation(TIMES), body.angular_velocity(TIMES)
        np.testing.assert_allclose(frames @ frames.swapaxes(1, 2), np.tile(np.eye(3), (61, 1, 1)), atol=1e-12)
        momentum = np.einsum("kji,kj->ki", frames, rates @ inertia)
        np.testing.assert_allclose(momentum, np.tile(inertia @ spin, (61, 1)), atol=1e-10)
        turning = -np.cross(rates, rates @ inertia) / np.array(moments)
        sizes, changes = np.linalg.norm(rates, axis=1).max(), np.linalg.norm(turning, axis=1).max()
        assert sizes <= body.rate_bounds()[0] * (1.0 + 1e-12)
        assert changes <= body.rate_bounds()[1] + 1e-16
        tumble = Tumble(body.inertia, body.attitude, spin, MEAN_MOTION, "lvlh")
        omega, change = tumble.rates()
        assert sizes <= omega * (1.0 + 1e-12)
        assert changes <= change + 1e-16
        # Not only bounds: the motion comes to them within 300 s, as one square stays and the others trade.
        assert omega <= sizes * (1.0 + 1e-6) + 1e-300
        motion = Sampled(MEAN_MOTION, 1.0)
        low, high = bracket(tumble, motion, 0.075)
        assert 0.0 < low <= high
        assert low >= 0.7 * high
        assert ball_radius(tumble, motion, 0.075) <= high * (1.0 + 1e-9)
        assert printed_radius(tumble, motion, 0.075) > 0.0


def test_two_moments_nearly_equal_are_as_two_equal_ones():
    near, equal = (
        Tumble(
            ((1000.0, 0.0, 0.0), (0.0, second, 0.0), (0.0, 0.0, 1500.0)),
            (1.0, 0.0, 0.0, 0.0),
            (0.02, 0.03, 0.04),
            MEAN_MOTION,
        ).rates()
        for second in (1000.0 * (1.0 + 1e-9), 1000.0)
    )
    assert near == pytest.approx(equal, rel=1e-8)
    assert equal[1] == pytest.approx(0.5 * 0.04 * math.hypot(0.02, 0.03), rel=1e-9)
