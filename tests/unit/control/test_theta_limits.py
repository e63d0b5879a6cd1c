"""How far from the target the input suffices: paper 002's bound, ours, and the truth by sampling."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from safestart.control.tracking_mpc import equilibrium
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.theta_radius import ball_radius, bracket, printed_radius
from safestart.control.tracking_mpc.theta_set import corner_cut, cut_inside, printed_cut, theta_set
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import Tuning
from tests.unit.tracking.envisat import INERTIA, MEAN_MOTION, SHAPE, envisat

MOTION = Sampled(MEAN_MOTION, 1.0)


def test_the_papers_figures():
    radius = printed_radius(envisat(), MOTION, 0.075)
    assert radius == pytest.approx(3.5966, abs=5e-5)
    assert printed_cut(SHAPE, radius) == pytest.approx(2.008, abs=5e-4)
    assert cut_inside(SHAPE, radius) == pytest.approx(2.0093, abs=1e-4)


def test_our_bounds_on_it():
    assert ball_radius(envisat(), MOTION, 0.075) == pytest.approx(6.93, abs=0.005)
    low, high = bracket(envisat(), MOTION, 0.075)
    assert low < 8.284 <= high + 0.002
    assert 0.99 * high < low <= high


def test_near_a_principal_axis_the_printed_bound_is_unsafe():
    _, axes = np.linalg.eigh(np.array(INERTIA))
    spin = envisat(rate=tuple(math.radians(5.0) * axes[:, 2]))
    printed = printed_radius(spin, MOTION, 0.075)
    low, high = bracket(spin, MOTION, 0.075)
    assert printed == pytest.approx(53.9, abs=0.05)
    assert high == pytest.approx(9.62, abs=0.01)
    assert low > 9.61
    assert ball_radius(spin, MOTION, 0.075) <= high
    assert printed > 5.0 * high


@pytest.mark.parametrize("seed", range(6))
def test_the_rigorous_ball_and_the_bracket_hold(seed):
    """Every equilibrium inside ``ball`` and ``low``, at many times and attitudes, stays within the limit."""
    rng = np.random.default_rng(seed)
    moments = np.sort(rng.uniform(1.0, 3.0, 3)) * 100.0
    moments[2] = min(moments[2], 0.99 * (moments[0] + moments[1]))
    turn = Rotation.random(random_state=seed).as_matrix()
    inertia = turn @ np.diag(moments) @ turn.T
    inertia = 0.5 * (inertia + inertia.T)
    quaternion = Rotation.random(random_state=seed + 50).as_quat()[[3, 0, 1, 2]]
    reference = "lvlh" if seed % 2 else "inertial"
    tumble = Tumble(
        tuple(map(tuple, inertia.tolist())),
        tuple(quaternion),
        tuple(rng.normal(0, 0.05, 3)),
        1.1e-3,
        reference,
    )
    motion = Sampled(1.1e-3, 1.0)
    maps = equilibrium.inputs(motion, tumble.nodes(1.0, 3000))
    need = float(np.linalg.norm(maps, axis=2).max())
    low, high = bracket(tumble, motion, 0.05)
    assert ball_radius(tumble, motion, 0.05) <= low * (1.0 + 1e-9)
    assert low * need <= 0.05
    assert low <= high
    # The largest rate and its change, by sampling.
    times = np.linspace(0.0, tumble.body.polhode_period(), 4001)
    omega, change = tumble.rates()
    rate = tumble.body.angular_velocity(times)
    assert np.linalg.norm(rate, axis=1).max() == pytest.approx(omega, rel=1e-6)
    slope = np.gradient(rate, times, axis=0)
    assert np.linalg.norm(slope, axis=1)[1:-1].max() == pytest.approx(change, rel=1e-3)


def test_corners_at_the_limit():
    tumble = envisat()
    attitudes = tumble.nodes(1.0, 600)
    maps = equilibrium.inputs(MOTION, attitudes)
    y = corner_cut(SHAPE, maps, 0.075)
    corners = np.array([[sx * (0.1 + y), y, sz * (0.1 + y)] for sx in (-1, 1) for sz in (-1, 1)])
    assert np.abs(maps @ corners.T).max() == pytest.approx(0.075, abs=1e-12)
    limits = {
        name: theta_set(Tuning(theta_limit=name), SHAPE, tumble, MOTION, attitudes).y_max
        for name in ("printed", "ball", "corners")
    }
    assert limits["printed"] < limits["ball"] < limits["corners"] == y


def test_a_target_at_rest_limits_nothing():
    still = Tumble(INERTIA, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, "lvlh")
    motion = Sampled(0.0, 1.0)
    limit = theta_set(Tuning(u_max=0.01), SHAPE, still, motion, still.nodes(1.0, 50))
    assert limit.contains(np.array([0.0, 1000.0, 0.0]))
    assert bracket(still, motion, 0.01)[1] > 1e6
