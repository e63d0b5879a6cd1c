"""The lemmas behind `certified`, each by brute force: derivatives, thrust bounds, reach, the stopping angle."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safestart.closed_form import family
from safestart.closed_form.family import DEGREE, FIRST, SECOND, SMOOTH_STEP, SPANS, STEEPEST, family_of
from safestart.closed_form.members import stopping_angle
from safestart.closed_form.rates import GUARD, rates_of
from safestart.model.scenario import Chaser, Floats, Rest, Scenario, Target

fractions = st.floats(0.0, 1.0)


def bernstein(control: np.ndarray, s: Floats) -> np.ndarray:
    """The curve by its definition, (T, ...)."""
    d = len(control) - 1
    basis = np.stack([math.comb(d, j) * s**j * (1.0 - s) ** (d - j) for j in range(d + 1)], axis=-1)
    return basis @ control


def test_derivatives_and_pieces_are_those_of_the_curve() -> None:
    rng = np.random.default_rng(1)
    control = rng.normal(size=DEGREE + 1)
    s, h = np.linspace(0.1, 0.9, 9), 1e-4
    around = [bernstein(control, s + k * h) for k in (-1, 0, 1)]
    np.testing.assert_allclose(bernstein(FIRST @ control, s), (around[2] - around[0]) / (2 * h), atol=1e-5)
    np.testing.assert_allclose(
        bernstein(SECOND @ control, s), (around[2] - 2 * around[1] + around[0]) / h**2, atol=1e-5
    )
    split = (family._SPLIT @ control).reshape(family.PIECES, DEGREE + 1)
    for piece, corners in enumerate(split):
        np.testing.assert_allclose(
            bernstein(corners, s), bernstein(control, (piece + s) / family.PIECES), atol=1e-12
        )


def test_the_smooth_step_and_its_steepest_second_derivative() -> None:
    s = np.linspace(0.0, 1.0, 1001)
    np.testing.assert_allclose(bernstein(SMOOTH_STEP, s), 3 * s**2 - 2 * s**3, atol=1e-12)
    assert np.abs(bernstein(SECOND @ SMOOTH_STEP, s)).max() == pytest.approx(STEEPEST)


def thrusts(h: np.ndarray, span: float, omega: float, n: float, phase: float) -> Floats:
    """|u| / (W^2 |p|) along a member and standing at its end, from the equation of motion, phase by phase."""
    rate = omega + n
    s = np.linspace(0.0, 1.0, 801)
    place = bernstein(h, s)
    velocity, push = bernstein(FIRST @ h, s) * rate / span, bernstein(SECOND @ h, s) * (rate / span) ** 2
    times = s * span / rate

    def needed(q: np.ndarray, v: np.ndarray, a: np.ndarray, t: Floats) -> Floats:
        gravity = 1.5 * n * n * (q + np.exp(-2j * (omega * t + phase)) * np.conj(q)) - n * n * q
        return np.abs(a + 2j * rate * v - rate * rate * q - gravity) / rate**2

    moving = needed(place, velocity, push, times)
    later = times[-1] + np.linspace(0.0, 2.0 * math.pi / max(omega, 1e-3), 200)
    end = np.full(200, h[-1])
    return np.concatenate([moving, needed(end, 0.0 * end, 0.0 * end, later)])


@settings(max_examples=30)
@given(fractions, fractions, st.booleans(), st.integers(0, len(SPANS) - 1))
def test_a_member_never_needs_more_thrust_than_its_reach_says(
    share: float, angle: float, still: bool, member: int
) -> None:
    """All phases of the gravity gradient; for a small mean motion and for one that exceeds the tumble rate."""
    omega, n = 0.02 * (1.0 - share) ** 3 + 1e-6, 1.1e-3 * share
    speed, nu = (0.0 if still else omega / (omega + n)), n / (omega + n)
    found = family_of(speed, nu)
    h = found.shape[:, member]
    assert h[0] == 1.0
    assert h[6] == h[5]
    assert (FIRST @ h)[0] == pytest.approx(-1j * speed * SPANS[member], abs=1e-12)
    for phase in (0.0, 2.0 * math.pi * angle):
        assert thrusts(h, float(SPANS[member]), omega, n, phase).max() <= 1.0 / found.reach[member] + 1e-9


def test_the_reach_is_nearly_all_there_is() -> None:
    """Not cut by later members, the bound is within 3 % of the thrust that the curve really needs."""
    found = family_of(1.0, 0.0)
    steps = np.diff(found.reach)
    assert (steps > 0.0).all()
    for member in range(0, len(SPANS), 3):
        needed = thrusts(found.shape[:, member], float(SPANS[member]), 0.05, 0.0, 0.0).max()
        assert 0.97 < needed * found.reach[member] <= 1.0 + 1e-12
    assert found.reach[-1] > 3.7
    assert (np.diff(family_of(0.0, 0.0).reach) >= 0.0).all()
    assert family_of(0.0, 0.0).reach[-1] > 1.39


@given(fractions, fractions, st.floats(1e-6, 1.0))
def test_braking_needs_exactly_the_thrust_it_was_given(share: float, angle: float, part: float) -> None:
    """The curve p (1 - i lambda (t - t^2 / 2T)), its thrust over all of it: at most a_max, and most of it is used."""
    omega, n, thrust = 0.03 * (1.0 - share) + 1e-7, 1.1e-3 * share, 0.05
    rates = rates_of(Scenario(Target(omega, n), Chaser(thrust)), Rest.LVLH)
    rho = part * rates.brake_limit
    beta = float(stopping_angle(rates, np.array(rho)))
    radius, duration = rho / rates.scale, 2.0 * beta / omega
    t = np.linspace(0.0, duration, 401)
    q = radius * (1.0 - 1j * omega * (t - t**2 / (2.0 * duration)))
    v, a = -1j * omega * radius * (1.0 - t / duration), 1j * omega * radius / duration
    worst = 0.0
    for phase in (0.0, math.pi * angle, 0.5 * math.pi):
        gravity = 1.5 * n * n * (q + np.exp(-2j * (omega * t + phase)) * np.conj(q)) - n * n * q
        u = a + 2j * rates.rate * v - rates.rate**2 * q - gravity
        worst = max(worst, float(np.abs(u).max()))
    assert worst <= thrust * (1.0 - 0.9 * GUARD)
    standing = abs(q[-1]) * (omega**2 + 2 * omega * n + 3 * n * n)
    assert standing <= thrust
    assert abs(q[-1] - radius * (1.0 - 1j * beta)) < 1e-9 * radius + 1e-12
    if share == 0.0:
        assert worst > 0.8 * thrust


def test_braking_is_refused_from_where_it_costs_too_much() -> None:
    """At the limit the two stopping distances that fit the thrust are one; beyond it none does."""
    rates = rates_of(Scenario.of(2.0, 0.1, 0.0), Rest.LVLH)
    assert rates.brake_limit == pytest.approx(1.0 / math.sqrt(3.0))
    at_limit = float(stopping_angle(rates, np.array(rates.brake_limit)))
    assert at_limit == pytest.approx(math.sqrt(0.5), rel=1e-6)
    for beta in np.linspace(0.1, 2.0, 50):
        push = 1.0 / (2.0 * beta) + beta
        assert abs(cmath.sqrt(push**2 + 1.0)) >= 1.0 / rates.brake_limit - 1e-12


def test_the_body_rest_limit_is_the_known_bound() -> None:
    """omega^2 + 2 n omega + 3 n^2 times the range, as for starts at rest in the body frame since the beginning."""
    scenario = Scenario.of(1.0, 0.02)
    rates = rates_of(scenario, Rest.BODY)
    omega, n = scenario.target.tumble_rate, scenario.target.mean_motion
    limit = rates.brake_limit / rates.scale
    assert limit == pytest.approx(0.02 / (omega**2 + 2 * n * omega + 3 * n * n), rel=1e-8)
