"""Variants of the rendezvous: nonlinear dynamics, gains by Bryson's rule, the guard as a true circle."""

import numpy as np
import pytest

from benchmarks.peers.reach_audit import drift_excess, powered_excess, random_starts
from safestart.errors import InvalidInput
from safestart.passive_safety.flights.independent_flight import kepler, replay
from safestart.passive_safety.flights.rk8_flights import simulate
from safestart.passive_safety.flights.simulate import active, crossing_times, flown
from safestart.passive_safety.gains import PUBLISHED_DESIGN, Bryson, Design
from safestart.passive_safety.model import (
    MU,
    PUBLISHED,
    RADIUS,
    Dynamics,
    Mode,
    Motion,
    System,
    coefficients,
    gain,
    matrix,
)
from safestart.passive_safety.question import Question, Verdict
from safestart.passive_safety.reach import nonlinear
from safestart.passive_safety.reach.reach_set import reach
from safestart.passive_safety.switching_guard import GAP_GUARD, Guard, depth, gradient
from safestart.passive_safety.verify import verify

pytestmark = pytest.mark.slow

NONLINEAR = System(Dynamics.NONLINEAR)
CIRCLE = System(guard=Guard.CIRCLE)
BRYSON = System(Dynamics.NONLINEAR, PUBLISHED_DESIGN, Guard.CIRCLE)
GENTLE = System(
    Dynamics.NONLINEAR,
    Design(Bryson((1000.0, 1000.0), (20.0, 20.0), 20_000.0), Bryson((100.0, 100.0), (3.0, 3.0), 20_000.0)),
)
VARIANTS = pytest.mark.parametrize(
    "system", [NONLINEAR, CIRCLE, BRYSON, GENTLE], ids=["nonlinear", "circle", "all", "gentle"]
)


def test_linearisation_is_the_derivative_of_keplers_motion() -> None:
    a = matrix(Motion(Mode.PASSIVE, Dynamics.NONLINEAR))
    for j, step in enumerate((1.0, 1.0, 1.0, 1.0)):
        there = step * np.eye(4)[j]
        slope = (kepler(there, np.zeros(2)) - kepler(-there, np.zeros(2))) / (2.0 * step)
        assert slope == pytest.approx(a[:, j], abs=1e-11)
    three_n2, two_n = coefficients(Dynamics.NONLINEAR)
    assert float(two_n) / 2.0 == pytest.approx(0.0043752935, rel=1e-7)
    assert abs(three_n2 - 3 * (two_n / 2) ** 2) < 1e-58


def test_gravity_remainder_bounds_what_the_linearisation_leaves_out_and_not_by_much() -> None:
    a = matrix(Motion(Mode.PASSIVE, Dynamics.NONLINEAR))
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    for radius in (1e3, 1e5, 3e6):
        bound = float(nonlinear.gravity_remainder(np.array(radius)))
        states = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle, 0 * angle], axis=1)
        left = np.array([kepler(z, np.zeros(2)) - a @ z for z in states])
        worst = np.hypot(left[:, 2], left[:, 3]).max()
        assert worst <= bound * (1 + 1e-6)
        assert worst >= 0.75 * bound
    assert nonlinear.gravity_remainder(np.array(0.6 * RADIUS)) == np.inf
    assert pytest.approx(3 * MU * 1e6 / (RADIUS - 1e3) ** 4) == nonlinear.gravity_remainder(np.array(1e3))


def test_a_deviation_without_a_proved_radius_is_unbounded() -> None:
    per_unit = np.ones((3, 4)) * np.array([1.0, 1e12, 1e30])[:, None]
    strays = nonlinear.deviation(per_unit, np.array([1e3, 1e3, 1e3]))
    assert strays[0, 0] < 1e-5
    assert strays[2, 0] == nonlinear.UNBOUNDED
    far = Question(centre=(-900.0, -400.0, 60.0, 60.0), window=(0.0, 0.0), system=NONLINEAR)
    assert verify(far).findings["separation"].verdict is Verdict.SAFE


@pytest.mark.parametrize("system", [PUBLISHED, CIRCLE], ids=["octagon", "circle"])
def test_integrator_agrees_with_the_exact_flight(system: System) -> None:
    starts = random_starts(Question(), 30, 3)
    times = np.random.default_rng(0).uniform(0.0, 300.0, (30, 8))
    crossing = crossing_times(system, starts, 300.0)
    states, entries = simulate(system, starts, np.full(30, np.inf), times)
    assert entries == pytest.approx(crossing, abs=1e-9)
    assert states == pytest.approx(active(system, starts[:, None], crossing[:, None], times), abs=1e-8)


def test_integrator_agrees_with_the_replay_of_another_library() -> None:
    starts = random_starts(Question(), 3, 3)
    times = np.array([[60.0, 111.5, 130.0, 290.0]] * 3)
    states, _ = simulate(NONLINEAR, starts, np.full(3, 130.0), times)
    for n, k in ((0, 0), (0, 1), (1, 2), (2, 3)):
        assert replay(NONLINEAR, starts[n], 130.0, times[n, k]) == pytest.approx(states[n, k], abs=5e-6)


def test_nonlinear_and_linear_flights_differ() -> None:
    """By more than any tolerance here: the nonlinear tests are about another motion."""
    start, abort = np.array([-900.0, -400.0, 0.0, 0.0]), 60.0
    apart = replay(NONLINEAR, start, abort, 300.0) - replay(PUBLISHED, start, abort, 300.0)
    assert np.abs(apart[:2]).max() > 0.05


@VARIANTS
def test_no_simulated_flight_leaves_its_tube(system: System) -> None:
    question = Question(window=(0.0, 300.0), system=system)
    tubes = reach(question)
    assert tubes.entry.reason == ""
    assert powered_excess(question, tubes, 200, 7, 20) <= 0.0
    for level, drift_level in ((0, 0), (5, 4)):
        assert drift_excess(question, tubes, 300, 11, level, drift_level) <= 0.0


def test_leaving_out_the_remainder_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """A single start, aborted early and followed for long: what is left of its cells is thinner than the remainder."""
    question = Question(half=(0.0, 0.0, 0.0, 0.0), horizon=600.0, window=(20.0, 20.0), system=NONLINEAR)
    sound = drift_excess(question, reach(question), 200, 2, 0, 0)
    monkeypatch.setattr(nonlinear, "gravity_remainder", lambda radius: 0.0 * radius)
    assert sound <= 1e-12
    assert drift_excess(question, reach(question), 200, 2, 0, 0) > 0.1


def test_speed_as_a_true_disc_holds_after_the_true_circle() -> None:
    """4.953 cm/s flown, and proved below 5; after the octagon it is 5.24."""
    for system in (CIRCLE, BRYSON):
        finding = verify(Question(system=system)).findings["velocity_disc"]
        assert finding.verdict is Verdict.SAFE
        assert finding.bound is not None
        assert 4.95 <= finding.bound / 0.6 <= 4.98


@pytest.mark.parametrize("centre", [(-200.0, -900.0), (600.0, 700.0), (-900.0, 0.0), (0.0, 950.0)])
def test_circle_is_crossed_from_every_side(centre: tuple[float, float]) -> None:
    question = Question((*centre, 0.0, 0.0), window=(0.0, 200.0), system=CIRCLE)
    tubes = reach(question)
    (branch,) = tubes.branches
    starts = random_starts(question, 300, 5)
    crossing = crossing_times(CIRCLE, starts, 300.0)
    assert ((tubes.entry.first <= crossing) & (crossing <= tubes.entry.last)).all()
    states = flown(Motion(Mode.FAR), starts, crossing)
    assert np.hypot(*states[:, :2].T) == pytest.approx(GAP_GUARD, abs=1e-6)
    # The crossing set is as narrow as the sag permits.
    normal = branch.crossing.normal
    heights = states[:, :2] @ normal
    most = float(branch.crossing.centre[:2] @ normal + np.abs(branch.crossing.gens[:, :2] @ normal).sum())
    assert heights.max() <= most <= heights.max() + 0.3
    assert powered_excess(question, tubes, 400, 5, 16) <= 0.0


def test_starts_from_all_sides_of_the_circle_are_refused_or_unknown() -> None:
    wide = Question((-400.0, 0.0, 0.0, 0.0), (200.0, 500.0, 0.0, 0.0), window=(0.0, 100.0), system=CIRCLE)
    findings = verify(wide).findings
    assert findings["thrust"].verdict is not Verdict.SAFE
    assert all(f.verdict is not Verdict.SAFE for f in findings.values())
    with pytest.raises(InvalidInput):
        Question((-110.0, 0.0, 0.0, 0.0), (25.0, 25.0, 0.0, 0.0), system=CIRCLE)


def test_guards_fall_along_their_gradient() -> None:
    places = np.random.default_rng(0).uniform(-200.0, 200.0, (50, 2))
    for guard in Guard:
        slope = gradient(guard, places)
        step = 1e-6
        rise = depth(guard, places + step * slope) - depth(guard, places)
        assert rise == pytest.approx(step * (slope**2).sum(axis=1), abs=1e-9)


def test_brysons_rule_gives_the_published_gains() -> None:
    for mode in (Mode.FAR, Mode.NEAR):
        ours, published = gain(Motion(mode, design=PUBLISHED_DESIGN)), gain(Motion(mode))
        assert np.abs(ours - published).max() <= 1e-7 * np.abs(published).max()
    assert np.linalg.eigvals(matrix(GENTLE.motion(Mode.NEAR))).real.max() < 0.0


def test_gains_of_our_own_are_optimal() -> None:
    """Riccati residual, in units of the largest term."""
    for system, mode in ((GENTLE, Mode.FAR), (BRYSON, Mode.NEAR)):
        motion = system.motion(mode)
        assert system.design is not None
        limits = system.design.near if mode is Mode.NEAR else system.design.far
        k = gain(motion)
        q = np.diag((limits.thrust / np.array([*limits.position, *limits.speed])) ** 2)
        closed = matrix(motion)
        # P of the cost of flying K for ever: K is optimal where it is B' P again.
        big = np.kron(closed.T, np.eye(4)) + np.kron(np.eye(4), closed.T)
        p = np.linalg.solve(big, -(q + k.T @ k).ravel()).reshape(4, 4)
        assert p[2:] / 500.0 == pytest.approx(k, rel=1e-6, abs=1e-6 * np.abs(k).max())


@pytest.mark.parametrize(
    ("values", "field"),
    [
        (((0.0, 1.0), (1.0, 1.0), 1.0), "position[0]"),
        (((1.0, 1.0), (1.0, float("nan")), 1.0), "speed[1]"),
        (((1.0, 1.0), (1.0, 1.0), -1.0), "thrust"),
    ],
)
def test_bad_limits_name_the_field(values: tuple, field: str) -> None:
    with pytest.raises(InvalidInput) as error:
        Bryson(*values)
    assert error.value.field == field
