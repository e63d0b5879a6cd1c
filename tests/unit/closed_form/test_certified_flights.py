"""GOs of `certified` are flown by an integrator that knows CWH and the paper's corridor, and nothing of the proof."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.peers.manoeuvre_flight import distances, fly
from safestart.closed_form.certified import ROUNDING, certify
from safestart.closed_form.family import SPANS
from safestart.closed_form.manoeuvre import manoeuvre_of
from safestart.closed_form.members import BRAKE
from safestart.model.scenario import Chaser, CorridorShape, Floats, Rest, Scenario, Target

TURNS = 0.7
"""Turns of the corridor flown after the manoeuvre; where it hardly turns, minutes."""


@st.composite
def questions(draw: st.DrawFn) -> tuple[Scenario, Rest, Floats]:
    """A scenario, a kind of rest and 60 starts, from everyday to extreme."""
    decades = st.floats(0.0, 1.0)
    omega = draw(st.sampled_from([0.0, 0.0, 1.0])) and 10.0 ** (-5.0 + 4.5 * draw(decades))
    n = draw(st.sampled_from([0.0, 5e-4, 1.1e-3, 1.3e-3]))
    thrust = 10.0 ** (-6.0 + 6.0 * draw(decades))
    shape = CorridorShape(
        10.0 ** (-1.5 + 3.0 * draw(decades)),
        10.0 ** (-1.5 + 3.0 * draw(decades)),
        draw(st.sampled_from([0.0, 0.1, 2.5, 100.0])),
        draw(st.sampled_from([0.0, 0.1, 2.5, 100.0])),
        draw(st.sampled_from([0.0, 0.5, 5.0])),
    )
    scenario = Scenario(Target(omega, n), Chaser(thrust), shape)
    dimensions, rest = draw(st.sampled_from([2, 3])), draw(st.sampled_from(list(Rest)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    rate = omega + n
    unit = min(thrust / rate**2, 3000.0) if rate > 0.0 else 1000.0
    y = shape.hold_radius + unit * rng.uniform(0.0, 4.0, 60)
    x = rng.uniform(-1.0, 1.0, 60) * (shape.x0 + shape.c_x * (y - shape.hold_radius))
    z = rng.uniform(-1.0, 1.0, 60) * (shape.z0 + shape.c_z * (y - shape.hold_radius))
    return scenario, rest, np.stack([x, y, z], axis=-1)[:, :dimensions]


@settings(max_examples=40)
@given(questions())
def test_each_kind_of_go_keeps_its_margin_within_its_thrust(asked: tuple[Scenario, Rest, Floats]) -> None:
    scenario, rest, points = asked
    found = certify(scenario, points, rest)
    omega = scenario.target.tumble_rate
    after = min(2.0 * math.pi * TURNS / omega, 3000.0) if omega > 0.0 else 600.0
    # One GO of each kind of manoeuvre, the one with the least room.
    kinds: dict[tuple[bool, bool], int] = {}
    for i in np.flatnonzero(found.go)[np.argsort(found.margin[found.go])].tolist():
        kinds.setdefault((int(found.member[i]) == BRAKE, float(found.drop[i]) > 0.0), i)
    for i in kinds.values():
        plan = manoeuvre_of(scenario, points[i], rest)
        assert plan is not None
        flown = fly(scenario, rest, points[i], plan, after)
        reach = float(np.linalg.norm(points[i]))
        # Open loop, CWH carries the integrator's error away with time: it is that error that is allowed for.
        error = 1e-6 + 1e-7 * reach
        assert flown.thrust <= 1.0
        assert flown.off < error
        assert flown.drift < 1e-6 + 1e-8 * reach
        assert flown.least >= float(found.margin[i]) - error


@pytest.mark.parametrize("rest", list(Rest))
@pytest.mark.parametrize(("rate", "thrust"), [(1.0, 0.01), (3.0, 0.1), (5.0, 0.2), (0.05, 1e-3)])
def test_starts_on_the_edge_of_the_certificate(rate: float, thrust: float, rest: Rest) -> None:
    """Where room or thrust run out, on 8 rays: the last start accepted is flown; some touch the thrust limit."""
    scenario = Scenario.of(rate, thrust)
    anchor = np.array([0.0, 1.0])
    angles = np.linspace(-0.97, 0.97, 8)
    unit = thrust / (scenario.target.tumble_rate + 1.1e-3) ** 2
    far = anchor + 5.0 * unit * np.stack([np.sin(angles), np.cos(angles)], axis=-1)
    low, high = np.zeros(8), np.ones(8)
    for _ in range(50):
        middle = 0.5 * (low + high)
        go = certify(scenario, anchor + middle[:, None] * (far - anchor), rest).go
        low, high = np.where(go, middle, low), np.where(go, high, middle)
    points = anchor + low[:, None] * (far - anchor)
    found = certify(scenario, points, rest)
    assert found.go.all()
    pushed = []
    for point, margin in zip(points, found.margin, strict=True):
        plan = manoeuvre_of(scenario, point, rest)
        assert plan is not None
        flown = fly(scenario, rest, point, plan, 0.3 * 2.0 * math.pi / scenario.target.tumble_rate, 120)
        assert flown.thrust <= 1.0
        assert flown.least >= float(margin) - 1e-6 - 1e-7 * float(np.linalg.norm(point))
        pushed.append(flown.thrust)
    assert max(pushed) > 0.9


def test_a_manoeuvre_starts_at_rest_where_it_says_and_ends_at_rest() -> None:
    scenario = Scenario.of(3.0, 0.1)
    rng = np.random.default_rng(5)
    points = np.stack(
        [rng.uniform(-60, 40, 300), rng.uniform(1, 100, 300), rng.uniform(-40, 40, 300)], axis=-1
    )
    omega = scenario.target.tumble_rate
    kinds = set()
    for rest in Rest:
        found = certify(scenario, points, rest)
        for i in np.flatnonzero(found.go):
            plan = manoeuvre_of(scenario, points[i], rest)
            assert plan is not None
            kinds.add((int(found.member[i]) == BRAKE, float(found.drop[i]) > 0.0, plan.duration > 0.0))
            place, velocity, _ = plan.motion(np.array([0.0, plan.duration * (1 + 1e-12) + 1e-9]))
            np.testing.assert_array_equal(place[0], points[i])
            wanted = (
                omega * np.array([points[i][1], -points[i][0], 0.0]) if rest is Rest.LVLH else np.zeros(3)
            )
            np.testing.assert_allclose(velocity[0], wanted, atol=1e-10)
            np.testing.assert_array_equal(velocity[1], 0.0)
            before, slow, _ = plan.motion(np.array([plan.duration]))
            np.testing.assert_allclose(before[0], place[1], atol=1e-9)
            np.testing.assert_allclose(slow[0], 0.0, atol=1e-9)
            if int(found.member[i]) != BRAKE:
                assert plan.duration == pytest.approx(SPANS[int(found.member[i])] / (omega + 1.1e-3))
            corners = plan.start + plan.away
            room = distances(scenario, corners, 3).min()
            assert float(found.margin[i]) == pytest.approx(room - ROUNDING, abs=1e-9)
    assert kinds == {(True, False, True), (True, False, False), (False, False, True), (False, True, True)}


def test_no_manoeuvre_without_a_go() -> None:
    assert manoeuvre_of(Scenario.of(2.0, 0.05), np.array([9.364, 81.044])) is None
