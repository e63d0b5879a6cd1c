"""What is not known beside the start: the bounds hold for drawn members, and every GO suits all of them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from safestart.attitude.in_lvlh import InLvlh, torque_free
from safestart.attitude.quaternion import matrix_of
from safestart.attitude.spin import Spin
from safestart.attitude.table import Table
from safestart.attitude.torque_free import TorqueFree
from safestart.constraints.thrust_limit import ThrustLimit, ball
from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.question import Goal
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.question import Face, SpaceQuestion, five_faces
from safestart.exact.space.spread import angles, drifts
from safestart.exact.space.start_box import decide_from_box
from safestart.exact.space.unknowns import Unknowns
from safestart.exact.space.watch import space_watch_of
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import CorridorShape, Floats

BODIES = (
    ((17023.3, 397.1, -2171.4), (397.1, 124825.7, 344.2), (-2171.4, 344.2, 129112.2)),
    ((120.0, 2.0, -1.0), (2.0, 100.0, 3.0), (-1.0, 3.0, 60.0)),
    ((38190.0, 0.0, 0.0), (0.0, 6165.0, 0.0), (0.0, 0.0, 38190.0)),
)
FACES = (*five_faces(CorridorShape()), Face("far", (0.3, 1.0, 0.2), 90.0, "lvlh"))
STATE = np.array([2.0, 30.0, 1.0, 0.05, -0.1, 0.02])
LOW = KeplerOrbit.of(7.2e6, 0.02, 0.5)


def within(rng: np.random.Generator, size: float) -> Floats:
    """A vector whose length is ``size``: members at the edge are the hardest."""
    found = rng.normal(size=3)
    return found * size / np.linalg.norm(found)


def member_of(body: TorqueFree, unknowns: Unknowns, rng: np.random.Generator, times: Floats) -> Floats:
    """Attitudes (T, 3, 3) of a member, Euler's equations integrated by SciPy."""
    inertia = np.array(body.inertia)
    inertia += np.diag(np.diag(inertia) * unknowns.inertia * rng.choice([-1.0, 1.0], 3))
    turn = within(rng, unknowns.angle)
    half = 0.5 * np.linalg.norm(turn)
    first = matrix_of(np.array([math.cos(half), *(0.5 * np.sinc(half / math.pi) * turn)])) @ matrix_of(
        np.array(body.attitude)
    )
    rate = np.array(body.body_rate) + within(rng, unknowns.rate)

    def rates(_: float, y: Floats) -> Floats:
        w, c = y[:3], y[3:].reshape(3, 3)
        return np.concatenate(
            [np.linalg.solve(inertia, np.cross(inertia @ w, w)), -np.cross(w, c, axisb=0, axisc=0).ravel()]
        )

    begin = np.concatenate([rate, first.ravel()])
    found = solve_ivp(rates, (0.0, times[-1]), begin, "DOP853", times, rtol=1e-10, atol=1e-12)
    out: Floats = found.y[3:].T.reshape(-1, 3, 3)
    return out


def between(first: Floats, second: Floats) -> Floats:
    """Angles (T,) of two courses of attitudes (T, 3, 3)."""
    cosine = 0.5 * (np.einsum("tij,tij->t", first, second) - 1.0)
    out: Floats = np.arccos(np.clip(cosine, -1.0, 1.0))
    return out


@pytest.mark.parametrize("inertia", BODIES)
@pytest.mark.parametrize(
    "unknowns",
    [Unknowns(rate=2e-4), Unknowns(inertia=0.02), Unknowns(angle=0.02, rate=1e-3, inertia=0.01)],
)
def test_no_member_turns_further_than_the_bound(inertia: Any, unknowns: Unknowns) -> None:
    rng, times = np.random.default_rng(3), np.linspace(0.0, 60.0, 61)
    shares = []
    for _ in range(12):
        rate = within(rng, rng.uniform(0.005, 0.06))
        body = TorqueFree(inertia, (0.9, 0.1, -0.2, 0.3), tuple(rate.tolist()))
        bound = angles(body, unknowns, times, 2.0)
        if not np.isfinite(bound).all():
            assert np.isinf(bound).all()
            continue
        assert (np.diff(bound, 2) > -1e-12).all()
        seen = between(member_of(body, unknowns, rng, times), body.rotation(times))
        assert (seen <= bound + 1e-7).all()
        shares.append(seen[-1] / bound[-1])
    # The bound is of use: some member comes near it.
    assert len(shares) >= 4
    assert max(shares) > (0.25 if unknowns.rate else 0.01)


def test_a_spin_and_a_table_are_off_by_the_rate_and_the_time() -> None:
    times, unknowns = np.array([0.0, 10.0, 60.0]), Unknowns(0.01, 1e-3)
    for attitude in (
        Spin(0.05),
        InLvlh(Spin(0.05), LOW),
        Table((0.0, 60.0), ((1, 0, 0, 0), (0.9, 0, 0, 0.1))),
    ):
        assert angles(attitude, unknowns, times, 2.0).tolist() == pytest.approx([0.01, 0.02, 0.07])
    one = Spin(0.051, phase=0.01).rotation(times)
    assert between(one, Spin(0.05).rotation(times)).tolist() == pytest.approx([0.01, 0.02, 0.07], abs=1e-6)


@pytest.mark.parametrize("orbit", [KeplerOrbit(0.0), KeplerOrbit(1.1e-3), KeplerOrbit.of(2.4e7, 0.7, 0.0)])
def test_no_force_moves_the_chaser_further_than_the_bound(orbit: KeplerOrbit) -> None:
    """Constant in LVLH, and radial as seen from inertial axes: each within the bound, and near it."""
    question = SpaceQuestion(orbit, Spin(0.01), FACES, ball(1.0), steps=150)
    watch, times = space_watch_of(question), 2.0 * np.arange(1, 151)
    bound = drifts(orbit, Unknowns(disturbance=0.01), np.concatenate([[0.0], times]))
    assert bound[0] == 0.0
    for axis in np.eye(3):
        nodes = watch.flown(np.zeros(6), np.tile(0.01 * axis, (150, 1)))[:, :3]
        moved = np.linalg.norm(nodes[np.searchsorted(watch.sample_times, times - 1e-9)], axis=1)
        assert (moved <= bound[1:] * (1.0 + 1e-9)).all()
        assert moved[4] > 0.999 * bound[5]


def drawn(seed: int) -> tuple[SpaceQuestion, Floats, Floats]:
    rng = np.random.default_rng([5, seed])
    orbit = [LOW, KeplerOrbit(1.1e-3), KeplerOrbit.of(2.4e7, 0.7, -0.1)][seed % 3]
    rate = tuple(within(rng, rng.uniform(0.01, 0.05)).tolist())
    attitude: Any = torque_free(BODIES[seed % len(BODIES)], (1.0, 0.0, 0.0, 0.0), rate, "inertial", orbit)
    unknowns = Unknowns(
        float(rng.uniform(0, 0.03)),
        float(rng.uniform(0, 5e-4)),
        float(rng.uniform(0, 0.02)),
        float(rng.uniform(0, 2e-3)),
    )
    box = ThrustLimit("box", (0.1, 0.1, 0.1))
    thrust = [ball(0.1), box][seed % 2]
    question = SpaceQuestion(orbit, attitude, FACES, thrust, unknowns=unknowns, steps=20)
    half = np.repeat([float(rng.uniform(0.0, 0.5)), float(rng.uniform(0.0, 0.02))], 3) * (seed % 2)
    state = STATE + np.concatenate([rng.uniform(-2, 2, 3), np.zeros(3)])
    return question, state, half


@pytest.mark.parametrize("seed", range(8))
def test_a_go_suits_every_member_that_is_drawn(seed: int) -> None:
    question, state, half = drawn(seed)
    answer = decide_from_box(question, state, half)
    nominal = decide_from_box(replace(question, unknowns=Unknowns()), state, half)
    assert answer.verdict is Verdict.GO
    assert answer.lower < nominal.lower
    rng, watch = np.random.default_rng(seed), space_watch_of(question)
    times, own = np.unique(watch.sample_times, return_index=True)
    turn = question.orbit.turned(times)
    c, s = np.cos(turn), np.sin(turn)
    lvlh = np.zeros((len(times), 3, 3))
    lvlh[:, 0, 0], lvlh[:, 0, 1], lvlh[:, 1, 0], lvlh[:, 1, 1], lvlh[:, 2, 2] = c, -s, s, c, 1.0
    least = math.inf
    for _ in range(6):
        seen = member_of(question.attitude.inertial, question.unknowns, rng, times) @ lvlh
        push = np.stack([within(rng, question.unknowns.disturbance) for _ in range(question.steps)])
        start = state + half * rng.choice([-1.0, 1.0], 6)
        shares = answer.thrust + push / (question.thrust.a_max[0] if question.thrust.kind == "box" else 1.0)
        flown = watch.flown(start, shares)[own, :3]
        body = np.einsum("tij,tj->ti", seen, flown)
        for face in question.faces:
            place = body if face.frame == "body" else flown
            distance = (face.offset - place @ np.array(face.normal)) / np.linalg.norm(face.normal)
            least = min(least, float(distance.min()))
    assert least >= answer.lower


def test_nothing_unknown_is_the_answer_of_before_and_small_unknowns_come_near_it() -> None:
    question, state, _ = drawn(0)
    known = decide_in_space(replace(question, unknowns=Unknowns()), state)
    little = decide_in_space(replace(question, unknowns=Unknowns(1e-6, 1e-9, 1e-6, 1e-8)), state)
    assert known.lower - 3e-3 < little.lower < known.lower


def test_a_no_go_stands_and_too_much_is_undecided_with_its_reason() -> None:
    question, state, _ = drawn(0)
    lost = state + np.array([0, 0, 0, 6.0, 0, 0])
    assert decide_in_space(question, lost).verdict is Verdict.NO_GO
    aside = state + np.array([25.0, 0, 0, 0, 0, 0])
    for unknowns, said in (
        (Unknowns(angle=0.5), "the attitude may be off by 29 deg"),
        (Unknowns(rate=0.1), "any way before the end"),
        (Unknowns(disturbance=0.5), "forces may move the chaser by 4e+02 m"),
    ):
        answer = decide_in_space(replace(question, unknowns=unknowns), aside if unknowns.angle else state)
        assert answer.verdict is Verdict.UNDECIDED
        assert said in answer.reason


def test_refusals() -> None:
    question, _, _ = drawn(0)
    with pytest.raises(InvalidInput, match="question"):
        replace(question, goal=Goal(1.0, 0.1, (0.0, 5.0, 0.0)))
    with pytest.raises(InvalidInput, match="speed"):
        replace(question, speed_limit=1.0)
    with pytest.raises(InvalidInput, match=r"thrust\.frame"):
        replace(question, thrust=ThrustLimit("box", (0.1, 0.1, 0.1), frame="body"))
    with pytest.raises(InvalidInput, match="inertia"):
        replace(question, attitude=Spin(0.01))
    with pytest.raises(InvalidInput, match="angle"):
        Unknowns(angle=-1.0)
