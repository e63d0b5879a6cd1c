"""Proofs for all members of what is not known in space: accepted, and no change goes unnoticed."""

from __future__ import annotations

import copy
import json
from functools import cache
from typing import Any

import numpy as np
import pytest

from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ball
from safestart.exact.space.prove import proof_in_space
from safestart.exact.space.question import Face, SpaceQuestion
from safestart.exact.space.start_box import decide_from_box
from safestart.exact.space.unknowns import Unknowns
from safestart.model.orbit import KeplerOrbit
from safestart.proofs.checker import check
from safestart.proofs.strict import ProofRejected
from tests.unit.exact.test_space_unknowns import drawn
from tests.unit.proofs.forgery import assert_all_is_read, assert_every_digit_counts, put, sealed

Document = dict[str, Any]
KEYS = ("attitude_rad", "rate_rad_s", "inertia_share", "disturbance_m_s2")


@cache
def proved(seed: int, *, go: bool = True) -> str:
    question, state, half = drawn(seed)
    if not go:
        state = state + np.array([0, 0, 0, 9.0, 0, 0])
    box = half if half.any() else None
    answer = decide_from_box(question, state, half)
    assert (answer.verdict == "GO") is go
    return json.dumps(proof_in_space(question, state, answer, box))


def document(seed: int, *, go: bool = True) -> Document:
    made: Document = json.loads(proved(seed, go=go))
    return made


@pytest.mark.parametrize("seed", range(6))
def test_every_answer_is_accepted(seed: int) -> None:
    made = document(seed)
    found = check(made)
    assert (found.verdict, found.margin_m) == ("GO", made["margin_m"])
    said = "\n".join(found.statement)
    assert "for every member" in said
    for key in KEYS:
        assert repr(made["question"]["unknowns"][key]) in said
    assert "no disturbance" not in said


@pytest.mark.parametrize("seed", [0, 1])
def test_a_no_go_is_that_of_the_stated_member(seed: int) -> None:
    lost = document(seed, go=False)
    refuted = check(lost)
    assert refuted.verdict == "NO_GO"
    assert any("the member that is as stated" in line for line in refuted.statement)
    for key in KEYS:
        assert repr(lost["question"]["unknowns"][key]) in "\n".join(refuted.statement)


@pytest.mark.parametrize("seed", [0, 1])
def test_what_is_not_read_is_refused(seed: int) -> None:
    assert_all_is_read(check, document(seed), without=("unknowns",))
    assert_every_digit_counts(check, document(seed), 40)


def refused(made: Document, path: tuple[Any, ...], value: Any) -> bool:
    forged = copy.deepcopy(made)
    put(forged, path, value)
    try:
        check(sealed(forged))
    except ProofRejected:
        return True
    return False


@pytest.mark.parametrize(("key", "more"), [*zip(KEYS, (0.03, 0.02, 0.4, 0.01), strict=True)])
def test_more_that_is_unknown_is_refused_and_less_is_not(key: str, more: float) -> None:
    made, path = document(1), ("question", "unknowns", key)
    value = made["question"]["unknowns"][key]
    assert not refused(made, path, 0.9 * value)
    assert refused(made, path, value + more)


def test_the_claim_is_near_what_the_checker_finds() -> None:
    """The prover gives away no more than centimetres of a margin."""
    made = document(0)
    assert refused(made, ("margin_m",), made["margin_m"] + 0.05)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            {
                "attitude": {
                    "kind": "spin",
                    "axis": [0, 0, 1],
                    "axis_frame": "lvlh",
                    "rate_rad_s": 0,
                    "phase_rad": 0,
                }
            },
            "inertia_share",
        ),
        ({"thrust": {"kind": "box", "a_max_m_s2": [0.1, 0.1, 0.1], "frame": "body"}}, "axes of LVLH"),
        ({"speed_limit": {"most_m_s": 10.0, "scale_s": 10.0}}, "unknowns"),
    ],
)
def test_what_is_not_proved_together_is_refused(change: Document, said: str) -> None:
    made = document(1 if "thrust" in change else 0)
    made["question"] |= change
    with pytest.raises(ProofRejected, match=said):
        check(sealed(made))


def test_a_force_is_bounded_within_a_step() -> None:
    """The nearest moment lies within a step of 2 s, where a chord of the force's drift is off by W h^2 / 8 = 5 mm."""
    wall = SpaceQuestion(
        KeplerOrbit(0.0),
        Spin(0.0),
        (Face("wall", (1.0, 0.0, 0.0), 20.0, "lvlh"),),
        ball(0.1),
        steps=3,
        unknowns=Unknowns(disturbance=0.01),
    )
    start = np.array([19.0, 5.0, 0.0, 0.1, 0.0, 0.0])
    answer = decide_from_box(wall, start, np.zeros(6))
    # 0.1 t - 0.09 t^2 / 2 is largest at t = 1.11 s: 1 - 0.0556 m, less the reserve.
    assert 0.943 < answer.lower < 0.9444
    assert check(json.loads(json.dumps(proof_in_space(wall, start, answer)))).verdict == "GO"


def test_a_box_of_starts_is_bounded_between_the_ends_of_a_part() -> None:
    """|r| around one value of it: a wide box and a fast flight cost more than either alone."""
    plane = SpaceQuestion(
        KeplerOrbit(0.0),
        Spin(0.0),
        (Face("wall", (0.0, 1.0, 0.0), 100.0), Face("back", (-1.0, 0.0, 0.0), 60.0)),
        ball(0.02),
        steps=2,
        unknowns=Unknowns(angle=0.6),
    )
    start, half = np.array([100.0, 0.0, 0.0, 2.0, 0.0, 0.0]), np.array([2.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    answer = decide_from_box(plane, start, half)
    assert answer.verdict == "GO"
    assert check(json.loads(json.dumps(proof_in_space(plane, start, answer, half)))).verdict == "GO"
