"""Proofs in space: every answer's document is accepted, by a checker of its own; no change of it goes unnoticed."""

from __future__ import annotations

import copy
import json
import time
from functools import cache
from typing import Any

import numpy as np
import pytest
from flint import arb, fmpq

from benchmarks.peers.space_cases import drawn
from safestart.attitude.in_lvlh import torque_free
from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ThrustLimit, ball
from safestart.dynamics.yamanaka_ankersen import YamanakaAnkersen
from safestart.exact.answer import Answer, Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.prove import proof_in_space
from safestart.exact.space.question import Face, SpaceQuestion, five_faces
from safestart.model.orbit import KeplerOrbit
from safestart.model.scenario import CorridorShape
from safestart.proofs.checker import check
from safestart.proofs.space.attitude import Course
from safestart.proofs.space.motion import Held, Motion
from safestart.proofs.space.orbit import Orbit
from safestart.proofs.space.statement import read
from safestart.proofs.strict import ProofRejected
from safestart.runtime.precision import precise
from tests.fuzzing.documents import original
from tests.unit.proofs.forgery import (
    assert_all_is_read,
    assert_every_digit_counts,
    assert_refused,
    changed,
    refused,
    sealed,
)

Document = dict[str, Any]


@cache
def proved(seed: int, verdict: str = "") -> str:
    """The document of a random case as JSON; of the first from ``seed`` on with that verdict, where one is named."""
    while True:
        question, state = drawn(seed, steps=12)
        answer = decide_in_space(question, state)
        if verdict in ("", answer.verdict.value) and answer.iterations:
            return json.dumps(proof_in_space(question, state, answer))
        seed += 1


def document(seed: int, verdict: str = "") -> Document:
    made: Document = json.loads(proved(seed, verdict))
    return made


@pytest.mark.parametrize("seed", range(16))
def test_every_answer_is_accepted(seed: int) -> None:
    made = document(100 * seed)
    found = check(made)
    assert (found.verdict, found.margin_m) == (made["verdict"], made["margin_m"])
    assert any("attitude" in line for line in found.statement)


@pytest.mark.parametrize("seed", range(6))
def test_attitude_and_motion_are_derived_again(seed: int) -> None:
    """The checker's balls hold what the solver's formulas say, and are thin."""
    question, state = drawn(200 + seed, steps=12)
    made = proof_in_space(question, state, decide_in_space(question, state))
    stated = read(json.loads(json.dumps(made)))
    with precise(240):
        orbit = Orbit(stated.mean_motion, stated.eccentricity, stated.true_anomaly)
        course, motion = Course(stated, orbit), Motion(orbit, stated.dt)
        for at in (0.0, 3.0, 7.3, 16.25, 24.0):
            turn = course.at(fmpq(*at.as_integer_ratio()))
            expected = question.attitude.rotation(np.array([at]))[0]
            for i in range(3):
                for j in range(3):
                    assert turn[i, j].rad() < 1e-15
                    assert abs(float(turn[i, j]) - expected[i, j]) < 1e-12
        phi, held = Held(motion, 11).at(fmpq(13, 10))
        moves = YamanakaAnkersen(question.orbit)
        for found, expected in ((phi, moves.transition(22.0, 23.3)), (held, moves.held(22.0, 23.3))):
            for i in range(expected.shape[0]):
                for j in range(expected.shape[1]):
                    assert found[i, j].rad() < 1e-15
                    assert abs(float(found[i, j]) - expected[i, j]) < 1e-13 * 10.0
        assert arb(stated.dt) > 0


@pytest.mark.parametrize(("seed", "verdict"), [(0, "GO"), (9, "NO_GO"), (16, "GO"), (25, "GO"), (1, "NO_GO")])
def test_what_is_not_read_is_refused(seed: int, verdict: str) -> None:
    assert_all_is_read(check, document(seed, verdict))


BODY = ((120.0, 2.0, -1.0), (2.0, 100.0, 3.0), (-1.0, 3.0, 60.0))


@cache
def near(verdict: str, kind: str) -> Document:
    """A torque-free case whose margin is decided by everything that turns."""
    orbit = KeplerOrbit.of(2.4e7, 0.72, 0.2)
    attitude = torque_free(BODY, (0.9, 0.2, -0.3, 0.1), (0.02, -0.03, 0.05), "inertial", orbit)
    arms = np.concatenate([np.eye(3), -np.eye(3)]) + 0.1
    limits = {
        "ball": ball(0.03),
        "box": ThrustLimit("box", (0.03, 0.02, 0.025), frame="body"),
        "thrusters": ThrustLimit("thrusters", (0.04,) * 6, tuple(map(tuple, arms.tolist())), "body"),
    }
    faces = (*five_faces(CorridorShape()), Face("berth", (0.0, 0.0, 1.0), 30.0, "lvlh"))
    question = SpaceQuestion(orbit, attitude, faces, limits[kind], 2.0, 8)
    turn = attitude.rotation(np.zeros(1))[0]
    state = np.concatenate([np.array([1.0, 20.0, 0.5]) @ turn, np.zeros(3)])
    if verdict == "NO_GO":
        state[3:] = np.array([-1.6, 1.2, 2.0])
    answer = decide_in_space(question, state)
    assert answer.verdict.value == verdict
    made: Document = json.loads(json.dumps(proof_in_space(question, state, answer)))
    return made


@pytest.mark.parametrize(("verdict", "kind"), [("GO", "ball"), ("NO_GO", "box"), ("NO_GO", "thrusters")])
def test_harm_is_seen(verdict: str, kind: str) -> None:
    """A claim raised by micrometres, another body, orbit, start or corridor: refused, whatever the digest says."""
    made = copy.deepcopy(near(verdict, kind))
    check(made)
    with pytest.raises(ProofRejected):
        check(changed(made, "margin_m", made["margin_m"] + (1e-5 if verdict == "GO" else -1e-5)))
    harms: list[tuple[tuple[Any, ...], list[float]]] = [
        (("question", "orbit", "mean_motion_rad_s"), [0.9, 1.1]),
        (("question", "orbit", "eccentricity"), [0.9, 1.1]),
        (("question", "orbit", "true_anomaly_rad"), [0.5, 2.0]),
        (("question", "dt_s"), [0.99, 1.01]),
        (("question", "thrust", "a_max_m_s2"), [1.1, 0.9]),
        (("start", "position_m"), [0.9, 1.1]),
        (("question", "attitude", "body_rate_rad_s", 0), [0.9, 1.1]),
        (("question", "attitude", "attitude_wxyz", 3), [0.9, 1.1]),
        (("question", "attitude", "inertia_kg_m2", 2, 2), [0.9, 1.1]),
    ]
    for path, factors in harms:
        # A change may help the claim; the other way then harms it.
        assert any(refused(check, made, path, factor) for factor in factors), path


def test_thrusts_outside_their_set_are_refused() -> None:
    for kind, key, value, said in (
        ("ball", "thrust_m_s2", [0.03, 0.001, 0.0], "a_max"),
        ("box", "throttle", [1.0000000001, 0.0, 0.0], r"\[-1, 1\]"),
        ("thrusters", "throttle", [0.5, 0.5, 1e-12, 0.0, 0.0, 0.0], "at most 1"),
        ("thrusters", "throttle", [0.5, -1e-9, 0.0, 0.0, 0.0, 0.0], "at most 1"),
    ):

        def change(made: Document, key: str = key, value: list[float] = value) -> None:
            made[key][4] = value

        assert_refused(check, near("GO", kind), change, said)


def test_every_digit_counts() -> None:
    assert_every_digit_counts(check, document(0, "GO"), 150)
    assert_every_digit_counts(check, document(9, "NO_GO"), 150)


@pytest.mark.parametrize(
    ("inertia", "said"),
    [
        ([[1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 1.0]], "symmetric"),
        ([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]], "positive"),
        ([[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "positive"),
    ],
)
def test_no_body_is_refused(inertia: list[list[float]], said: str) -> None:
    with pytest.raises(ProofRejected, match=said):
        check(changed(near("GO", "ball"), "question.attitude.inertia_kg_m2", inertia))


def test_a_false_go_is_refused() -> None:
    """A history that leaves the corridor between the samples of its claim."""
    question = SpaceQuestion(
        KeplerOrbit(1.1e-3), Spin(0.05), five_faces(CorridorShape()), ball(0.05), 2.0, 30
    )
    state = np.array([2.0, 40.0, 0.0, 0.0, 0.0, 0.0])
    answer = Answer(Verdict.GO, 0.01, 0.01, 0.01, np.zeros((30, 3)), (), 1)
    with pytest.raises(ProofRejected, match="distance to"):
        check(json.loads(json.dumps(proof_in_space(question, state, answer))))


def test_verification_takes_seconds_at_most() -> None:
    """Two seconds are asked for on a quiet machine; the processor's time of a 60 s torque-free case."""
    question, state = drawn(16, steps=30)
    made = json.loads(json.dumps(proof_in_space(question, state, decide_in_space(question, state))))
    begin = time.process_time()
    check(made)
    assert time.process_time() - begin < 8.0


def test_a_table_of_attitudes_is_printed() -> None:
    """Two tables once read alike: "by slerp between 3 quaternions" was all that the statement said of the turning."""
    made = json.loads(original("space-table-go"))
    said = check(made).statement
    table = made["question"]["attitude"]
    for time_s, q in zip(table["times_s"], table["attitude_wxyz"], strict=True):
        assert f"attitude at {time_s!r} s: {q}" in said
    table["attitude_wxyz"][1][3] += 0.01
    made["margin_m"] -= 0.5
    other = check(sealed(made)).statement
    assert other != said
    # An entry after the horizon says nothing.
    table["times_s"].append(100.0)
    table["attitude_wxyz"].append([1.0, 0.0, 0.0, 0.0])
    assert check(sealed(made)).statement == other
