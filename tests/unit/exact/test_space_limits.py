"""Ends at rest, speed limits and boxes of starts in space: dense programs, the planar answers, symmetries."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.peers.space_limits import KINDS, Dense, wide
from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ball
from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.question import Goal, Question
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.question import Face, SpaceQuestion, five_faces
from safestart.exact.space.start_box import decide_from_box
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import CorridorShape, Scenario
from tests.unit.exact.test_space import PARTS, assert_refused

CORRIDOR = five_faces(CorridorShape())
HOLD = (0.0, 0.5, 0.0)


@pytest.mark.parametrize("seed", [0, 1, 4, 5, 10, 11, 13, 18, 26, 27, 34, 35])
def test_agrees_with_a_dense_program(seed: int) -> None:
    """The program checks four times a step, so its margin may be a bit above ours."""
    question, state, half = wide(seed)
    box = KINDS[seed % len(KINDS)] == "box"
    answer = decide_from_box(question, state, half) if box else decide_in_space(question, state)
    dense = Dense(question, state, half)
    inside, outside = dense.margin(inside=True), dense.margin(inside=False)
    if answer.verdict is Verdict.GO:
        assert answer.lower <= outside + 5e-3
        assert answer.upper >= inside - 0.02
        assert dense.kept(answer.thrust) >= answer.lower - 1e-3
    elif answer.verdict is Verdict.NO_GO:
        best = Dense(question, state, half, free=True).margin(inside=True) if box else inside
        assert answer.upper >= best - 0.02
    else:
        assert box
        assert inside < 0.02 < Dense(question, state, half, free=True).margin(inside=False) + 0.04


@pytest.mark.parametrize(
    ("y", "most", "verdict"), [(40.0, None, "GO"), (20.0, 0.3, "NO_GO"), (12.0, 1.0, "GO")]
)
def test_a_spin_about_the_normal_is_the_old_question(y: float, most: float | None, verdict: str) -> None:
    state = np.array([1.0, y, 0.5, 0.0, 0.0, 0.0])
    goal = Goal(hold=HOLD)
    old = decide(Question(Scenario.of(2.0, 0.05), 2.0, 60, 3, goal, most), state)
    spin = Spin(math.radians(2.0))
    new = SpaceQuestion(KeplerOrbit(1.1e-3), spin, CORRIDOR, ball(0.05), 2.0, 60, goal, most)
    found = decide_in_space(new, state)
    assert found.verdict.value == old.verdict.value == verdict
    assert found.margin_m == pytest.approx(old.margin_m, abs=1e-5)


def test_a_free_end_is_the_best_of_the_fixed_ones() -> None:
    question, state, _ = wide(2, 10)
    goal = replace(question.goal, earliest=1, radius=8.0, rest=1.5)
    free = decide_in_space(replace(question, goal=goal), state, tolerance=1e-5)
    fixed = [
        decide_in_space(replace(question, steps=k, goal=replace(goal, earliest=k)), state, tolerance=1e-5)
        for k in range(1, 11)
    ]
    assert any(one.verdict is Verdict.GO for one in fixed) is (free.verdict is Verdict.GO)
    if free.verdict is Verdict.NO_GO:
        assert free.upper >= max(one.lower for one in fixed) - 1e-9
    else:
        assert len(free.thrust) in [k for k, one in enumerate(fixed, 1) if one.verdict is Verdict.GO]


def test_reversed_spin_mirrors_without_an_orbit() -> None:
    mirror = np.array([-1.0, 1.0, 1.0])
    state = np.array([3.0, 15.0, 1.0, 0.1, -0.05, 0.02])
    goal = Goal(1.5, 0.2, (0.4, 3.0, -0.2), 30)
    found = []
    for rate, sign in ((0.04, np.ones(3)), (-0.04, mirror)):
        there = replace(goal, hold=tuple((sign * np.array(goal.hold)).tolist()))
        question = SpaceQuestion(
            KeplerOrbit(0.0), Spin(rate), CORRIDOR, ball(0.05), 2.0, 30, there, speed_limit=1.2
        )
        found.append(decide_in_space(question, state * np.tile(sign, 2), tolerance=1e-6))
    assert abs(found[0].lower - found[1].lower) < 3e-6
    assert found[0].verdict is Verdict.GO


def test_a_scenario_turned_about_z_keeps_its_margin() -> None:
    """On an elliptic orbit too: the body's own axes are turned, and nothing else changes."""
    angle = 0.7
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    orbit = KeplerOrbit.of(2.4e7, 0.7, 0.3)
    state = np.array([3.0, 15.0, 1.0, 0.1, -0.05, 0.02])
    found = []
    # Body axes turned back by the angle give coordinates turned forward, and the body is then as much behind.
    for m, phase in ((np.eye(3), 0.0), (turn, -angle)):
        faces = tuple(replace(f, normal=tuple((m @ np.array(f.normal)).tolist())) for f in CORRIDOR)
        goal = Goal(1.5, 0.2, tuple((m @ np.array([0.4, 3.0, -0.2])).tolist()), 20)
        spin = Spin(0.04, phase=phase)
        question = SpaceQuestion(orbit, spin, faces, ball(0.05), 2.0, 20, goal, 1.5)
        found.append(decide_in_space(question, state, tolerance=1e-6))
    assert abs(found[0].lower - found[1].lower) < 3e-6


def test_a_wider_box_is_harder_both_ways() -> None:
    question = SpaceQuestion(KeplerOrbit(1.1e-3), Spin(0.05, (0.3, 0.1, 0.9)), CORRIDOR, ball(0.05))
    state = np.array([3.0, 25.0, 1.0, 0.1, -0.05, 0.02])
    shares = np.array([1.0, 1.0, 1.0, 0.05, 0.05, 0.05])
    point = decide_in_space(question, state)
    found = [decide_from_box(question, state, width * shares) for width in (0.0, 0.5, 1.0, 4.0)]
    assert found[0].lower == pytest.approx(point.lower, abs=2e-4)
    assert found[0].lower > found[1].lower > found[2].lower > 0.0
    assert found[3].verdict is Verdict.UNDECIDED
    assert "some of them" in found[3].reason
    for sign in (np.ones(6), -np.ones(6)):
        corner = decide_in_space(question, state + sign * shares)
        assert corner.upper >= found[2].lower
    gone = np.array([3.0, 25.0, 1.0, 3.0, 0.0, 0.0])
    assert decide_from_box(question, gone, 0.5 * shares).verdict is Verdict.NO_GO
    outside = np.array([0.0, -5.0, 0.0, 0.0, 0.0, 0.0])
    assert decide_from_box(question, outside, shares).iterations == 0


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"goal": Goal()}, "hold"),
        ({"goal": Goal(hold=(0.0, 0.4, 0.0))}, "hold"),
        ({"goal": Goal(hold=(0.0, 1.0))}, "hold"),
        ({"goal": Goal(hold=HOLD, earliest=40)}, "earliest"),
        ({"speed_limit": 0.0}, "speed_limit"),
        ({"speed_limit": 1.0, "faces": (Face("speed", (0.0, 1.0, 0.0), 5.0),)}, "faces"),
    ],
)
def test_what_is_no_question_is_refused(changes: dict, field: str) -> None:
    assert_refused(changes, field)
    if "goal" not in changes:
        return
    with pytest.raises(InvalidInput):
        decide_from_box(
            SpaceQuestion(**PARTS, goal=Goal(hold=HOLD)), np.array([0.0, 9.0, 0, 0, 0, 0]), np.ones(6)
        )
