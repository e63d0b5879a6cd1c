"""Relabelled scenarios: turned about z, and mirrored, every flight and every proof has a twin of the same margin.

So the best margins are equal; the margins that an answer brackets to a tolerance could not show it to 1e-9 m.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from safestart.attitude.in_lvlh import InLvlh
from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ThrustLimit, ball
from safestart.exact.answer import Answer, Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.demands.rules import Demands, FieldOfView, KeepOut, Plume
from safestart.exact.space.question import Face, SpaceQuestion, five_faces
from safestart.exact.space.watch import space_watch_of
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import CorridorShape, Floats

CORRIDOR = (*five_faces(CorridorShape()), Face("far", (0.3, 1.0, 0.2), 90.0, "lvlh"))
STATE = np.array([3.0, 25.0, 1.0, 0.1, -0.05, 0.02])
LOST = np.array([3.0, 25.0, 1.0, 6.0, -0.05, 0.02])
AXIS = np.array([0.2, 0.1, 0.9])
STILL = KeplerOrbit(0.0)


def turned(angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def three(vector: Floats) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z


def twin(question: SpaceQuestion, m: Floats) -> SpaceQuestion:
    """The scenario with every vector moved by an orthogonal ``m``; a spin is turned the other way by a mirror."""
    spin = question.attitude
    sign = float(np.linalg.det(m))
    faces = tuple(replace(f, normal=three(m @ np.array(f.normal))) for f in question.faces)
    axis = three(sign * (m @ np.array(spin.axis)))
    demands = question.demands
    outs = tuple(replace(one, centre=three(m @ np.array(one.centre))) for one in demands.keep_outs)
    view = demands.view and replace(
        demands.view,
        axis=three(m @ np.array(demands.view.axis)),
        point=three(m @ np.array(demands.view.point)),
    )
    rule = demands.plume and replace(demands.plume, point=three(m @ np.array(demands.plume.point)))
    return replace(
        question, attitude=Spin(spin.rate, axis, spin.phase), faces=faces, demands=Demands(outs, view, rule)
    )


def moved(m: Floats, state: Floats) -> Floats:
    return np.concatenate([m @ state[:3], m @ state[3:]])


def assert_same(question: SpaceQuestion, other: SpaceQuestion, m: Floats, state: Floats) -> Answer:
    """The twins of one answer's flight and of its multipliers, each to 1e-9 m."""
    answer = decide_in_space(question, state)
    here, there = space_watch_of(question), space_watch_of(other)
    history = answer.thrust if answer.thrust is not None else np.zeros((question.steps, 3))
    history = history + 0.01 * np.random.default_rng(2).normal(size=history.shape)
    first = here.minima(state, history).lowest
    second = there.minima(moved(m, state), history @ m.T).lowest
    assert first == pytest.approx(second, abs=1e-9)
    if answer.multipliers:
        weights = np.array([row.value for row in answer.multipliers])
        times = np.array([row.time for row in answer.multipliers])
        faces = np.array([here.names.index(row.face) for row in answer.multipliers])
        bounds = []
        for watch, start in ((here, state), (there, moved(m, state))):
            cuts = watch.cuts(times, faces)
            pull = (weights @ cuts.thrust).reshape(1, -1, 3)
            reach = question.thrust_scale * question.thrust_set.support(pull)
            bounds.append(float(weights @ (cuts.offset + cuts.start @ start) + reach[0]))
        assert bounds[0] == pytest.approx(bounds[1], abs=1e-9)
        assert bounds[0] == pytest.approx(answer.upper, abs=1e-6)
    return answer


@pytest.mark.parametrize("state", [STATE, LOST])
@pytest.mark.parametrize("angle", [0.7, -2.3, math.pi])
def test_a_scenario_turned_about_z_has_the_same_margins(angle: float, state: Floats) -> None:
    question = SpaceQuestion(STILL, Spin(0.04, three(AXIS), 0.3), CORRIDOR, ball(0.05))
    m = turned(angle)
    answer = assert_same(question, twin(question, m), m, state)
    assert answer.verdict is (Verdict.GO if state is STATE else Verdict.NO_GO)


@pytest.mark.parametrize("state", [STATE, LOST])
def test_body_axes_turned_about_z_change_nothing_on_any_orbit(state: Floats) -> None:
    """LVLH is the orbit's and may not be turned; the axes that the body's coordinates refer to may."""
    orbit = KeplerOrbit.of(2.4e7, 0.7, 0.3)
    faces = CORRIDOR[:5]
    for angle in (0.7, -2.3):
        m = turned(angle)
        question = SpaceQuestion(orbit, InLvlh(Spin(0.04), orbit), faces, ball(0.05))
        other = replace(
            question,
            attitude=InLvlh(Spin(0.04, phase=-angle), orbit),
            faces=tuple(replace(f, normal=three(m @ np.array(f.normal))) for f in faces),
        )
        assert_same(question, other, np.eye(3), state)


@pytest.mark.parametrize("state", [STATE, LOST])
@pytest.mark.parametrize("mirror", [(-1.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, -1.0)])
def test_a_mirrored_spin_mirrors_the_answer_without_an_orbit(
    mirror: tuple[float, float, float], state: Floats
) -> None:
    m = np.diag(mirror)
    question = SpaceQuestion(STILL, Spin(0.04, three(AXIS)), CORRIDOR, ball(0.05))
    assert_same(question, twin(question, m), m, state)
    # With an orbit the Coriolis force knows one sense only, but across the orbit's plane.
    orbital = replace(question, orbit=KeplerOrbit(1.1e-3))
    other = twin(orbital, m)
    thrust = 0.02 * np.random.default_rng(1).normal(size=(orbital.steps, 3))
    first = space_watch_of(orbital).minima(state, thrust).lowest
    second = space_watch_of(other).minima(moved(m, state), thrust @ m.T).lowest
    assert (abs(first - second) < 1e-9) is (mirror[2] < 0.0)


def test_a_box_of_thrusts_turns_with_the_scenario_by_quarter_turns() -> None:
    box = ThrustLimit("box", (0.05, 0.05, 0.02))
    question = SpaceQuestion(STILL, Spin(0.04, three(AXIS)), CORRIDOR, box)
    m = turned(0.5 * math.pi).round()
    answer = decide_in_space(question, STATE)
    other = twin(question, m)
    first = space_watch_of(question).minima(STATE, answer.thrust).lowest
    second = space_watch_of(other).minima(moved(m, STATE), answer.thrust @ m.T).lowest
    assert first == pytest.approx(second, abs=1e-9)


@pytest.mark.parametrize("m", [turned(0.7), np.diag([-1.0, 1.0, 1.0])])
def test_demands_turn_with_the_scenario(m: Floats) -> None:
    """Their convex parts are found by a search, whose answers agree to its tolerance."""
    demands = Demands(
        (KeepOut("panel", (0.0, 12.0, 0.0), (4.0,)), KeepOut("mast", (1.0, 5.0, 0.0), (3.0,), "lvlh")),
        FieldOfView((0.0, -1.0, 0.0), math.radians(60.0)),
        Plume(math.radians(30.0), 60.0),
    )
    question = SpaceQuestion(STILL, Spin(0.04, three(AXIS)), CORRIDOR, ball(0.1), demands=demands)
    answer, other = decide_in_space(question, STATE), decide_in_space(twin(question, m), moved(m, STATE))
    assert answer.verdict is other.verdict is Verdict.GO
    rooms = [
        dict(one.demands.rooms(state[:3], state[:3]))
        for one, state in ((question, STATE), (twin(question, m), moved(m, STATE)))
    ]
    for name, room in rooms[0].items():
        assert rooms[1][name] == pytest.approx(room, abs=1e-9)
