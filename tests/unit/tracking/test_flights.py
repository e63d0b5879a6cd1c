"""Flights, their certificates, and flights with errors."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from safestart.control.tracking_mpc.tube import Errors, tube_of
from safestart.control.tracking_mpc.tuning import Tuning
from safestart.errors import InvalidInput
from safestart.tracking.certificate import cost_decrease, holds_until, recursion, shifts_needed
from safestart.tracking.flight import fly
from safestart.tracking.noisy_flight import Belief, NoisyFlights
from safestart.tracking.noisy_kernel import predict
from tests.unit.tracking.envisat import INERTIA, MEAN_MOTION, START, envisat, program

TUNINGS = (Tuning(rho=1.0, tau=1.0), Tuning(rho=1.0), Tuning())


@pytest.mark.parametrize("tuning", TUNINGS)
def test_no_start_loses_its_plan(tuning):
    """Random starts that have a plan keep one; every plan is certified for all later steps."""
    tumble, rng = envisat("inertial"), np.random.default_rng(int(tuning.rho + tuning.tau))
    mpc, attitudes = program(tuning, tumble=tumble, window=320)
    shifts = shifts_needed(mpc.condensed.closed)
    done = 0
    while done < 8:
        y = rng.uniform(0.5, 9.0)
        position = np.array([rng.uniform(-y, y), y, rng.uniform(-y, y)])
        start = np.concatenate([attitudes[0].T @ position, rng.normal(0.0, 0.02, 3)])
        flight = fly(mpc, tumble, attitudes, start, 60)
        if not flight.plans:
            continue
        done += 1
        assert flight.finished
        assert flight.least_slack >= -1e-9
        assert np.abs(flight.inputs).max() <= tuning.u_max + 1e-10
        assert all(recursion(mpc, attitudes[k:], plan, shifts).holds for k, plan in enumerate(flight.plans))
        assert cost_decrease(mpc, attitudes, flight) <= 1e-9


def test_a_short_tail_breaks_the_certificate():
    mpc, attitudes = program(Tuning(n_lqr=8), window=320)
    flight = fly(mpc, envisat(), attitudes, START, 40)
    shown = [recursion(mpc, attitudes[k:], plan, 121) for k, plan in enumerate(flight.plans)]
    assert not all(one.holds for one in shown)
    assert cost_decrease(mpc, attitudes, flight) > 1e-4


def test_the_certificate_s_candidates_are_plans():
    """One candidate, step by step: the shifted plan with a longer tail stays within the rows certified for it."""
    mpc, attitudes = program()
    plan = mpc.plan(attitudes, START)
    proof = recursion(mpc, attitudes, plan, 60)
    state, least = plan.states[3].copy(), np.inf
    last, gain = mpc.motion.dead_beat(), mpc.condensed.gain
    from safestart.control.tracking_mpc import equilibrium

    targets = equilibrium.states(mpc.motion, attitudes[:90]) @ plan.theta
    held = equilibrium.inputs(mpc.motion, attitudes[:90]) @ plan.theta
    for k in range(3, 60):
        law = gain if k < 3 + 30 + 20 else last
        given = held[k] + attitudes[k] @ law @ (state - targets[k])
        least = min(least, mpc.faces.slack(attitudes[k] @ state[:3]).min())
        assert np.abs(given).max() <= 0.075 + 1e-12
        state = mpc.motion.a @ state
        state[3:] += attitudes[k].T @ given
    assert least >= proof.corridor - 1e-12
    np.testing.assert_allclose(state, targets[60], atol=1e-12)


def test_errors_of_the_model_shorten_the_verdict():
    mpc, attitudes = program()
    flight = fly(mpc, envisat(), attitudes, START, 40)
    none = holds_until(mpc, envisat(), flight, 0.0, 0.0)
    some = holds_until(mpc, envisat(), flight, 0.02, 0.01)
    much = holds_until(mpc, envisat(), flight, 0.1, 0.1)
    assert none == 40.0
    assert none > some >= much


def test_two_bodies_differ_by_millimetres():
    mpc, attitudes = program(tumble=envisat("inertial"))
    one = fly(mpc, envisat("inertial"), attitudes, START, 20)
    two = fly(mpc, envisat("inertial"), attitudes, START, 20, "two_body_j2")
    assert 1e-9 < np.abs(one.states - two.states).max() < 5e-3


@pytest.mark.parametrize("reference", ["lvlh", "inertial"])
def test_attitudes_ahead_are_the_target_s(reference):
    tumble = envisat(reference)
    first = 25.0
    exact = tumble.attitude.rotation(first + np.arange(38.0))
    rate = np.ascontiguousarray(tumble.body.angular_velocity(np.array(first)))
    out, inertia = np.empty((38, 3, 3)), np.array(INERTIA)
    orbit = MEAN_MOTION if reference == "inertial" else 0.0
    predict(np.ascontiguousarray(exact[0]), rate, inertia, np.linalg.inv(inertia), orbit, 1.0, out)
    assert Rotation.from_matrix(out @ exact.swapaxes(1, 2)).magnitude().max() < 1e-5


def test_without_errors_the_noisy_flight_is_the_flight():
    tumble = envisat("inertial")
    mpc, attitudes = program(tumble=tumble, window=320)
    flight = fly(mpc, tumble, attitudes, START, 30)
    rates = np.ascontiguousarray(tumble.body.angular_velocity(np.arange(31.0)))
    for variant in ("hard", "soft"):
        flights = NoisyFlights(mpc, Belief(np.array(INERTIA), MEAN_MOTION), variant, None)
        done = flights.fly(START, attitudes[:31].copy(), rates, np.zeros((31, 6)), np.ones(30))
        assert done.last_range == pytest.approx(float(flight.ranges[-1]), abs=1e-6)
        assert done.impulse == pytest.approx(float(np.linalg.norm(flight.inputs, axis=1).sum()), abs=1e-5)
        assert done.least_slack == pytest.approx(flight.least_slack, abs=1e-5)


def test_the_filter_and_the_tube():
    mpc, _ = program()
    errors = Errors(0.01, 0.001, 0.00075)
    tube, wide = (
        tube_of(mpc.motion, mpc.tuning, errors),
        tube_of(mpc.motion, mpc.tuning, errors, bounded=True),
    )
    rng, state, estimate, misses = np.random.default_rng(0), np.zeros(6), np.zeros(6), []
    for _ in range(4000):
        state = mpc.motion.a @ state
        state[3:] += rng.normal(0.0, errors.impulse, 3) - 0.05 * state[3:] - 0.002 * state[:3]
        expected = mpc.motion.a @ estimate
        expected[3:] -= 0.05 * state[3:] + 0.002 * state[:3]
        measured = state + rng.normal(0.0, [0.01] * 3 + [0.001] * 3)
        estimate = expected + tube.gain @ (measured - expected)
        misses.append(estimate[0] - state[0])
    assert 3.0 * np.std(misses) == pytest.approx(tube.corridor[0], rel=0.15)
    assert tube.corridor[0] < 0.03
    assert (np.diff(tube.corridor) >= 0.0).all()
    assert (wide.corridor >= tube.corridor - 1e-15).all()
    with pytest.raises(InvalidInput, match="u_max"):
        tube_of(mpc.motion, mpc.tuning, Errors(5.0, 1.0, 0.07))
