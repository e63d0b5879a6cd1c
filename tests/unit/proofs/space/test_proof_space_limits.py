"""Proofs in space with an end at rest, a speed limit or a box of starts: accepted, and no change goes unnoticed."""

from __future__ import annotations

import copy
import json
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from benchmarks.peers.space_limits import KINDS, wide
from safestart.exact.answer import Answer, Multiplier, Verdict
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.prove import proof_in_space
from safestart.exact.space.start_box import decide_from_box
from safestart.proofs.checker import check
from safestart.proofs.strict import ProofRejected
from tests.unit.proofs.forgery import assert_all_is_read, assert_every_digit_counts, put, refused, sealed

Document = dict[str, Any]


@cache
def proved(kind: str, verdict: str) -> str:
    """The document of the first such case that takes a program, as JSON; ends from step 1 on count."""
    seed = KINDS.index(kind)
    while True:
        question, state, half = wide(seed, 10)
        if question.goal is not None:
            question = replace(question, goal=replace(question.goal, earliest=8))
        box = half if kind == "box" else None
        answer = decide_in_space(question, state) if box is None else decide_from_box(question, state, half)
        if answer.verdict.value == verdict and answer.iterations:
            return json.dumps(proof_in_space(question, state, answer, box))
        seed += len(KINDS)


def document(kind: str, verdict: str) -> Document:
    made: Document = json.loads(proved(kind, verdict))
    return made


CASES = [(kind, verdict) for kind in KINDS for verdict in ("GO", "NO_GO")]


@pytest.mark.parametrize(("kind", "verdict"), CASES)
def test_every_answer_is_accepted_and_said_in_full(kind: str, verdict: str) -> None:
    made = document(kind, verdict)
    found = check(made)
    assert (found.verdict, found.margin_m) == (verdict, made["margin_m"])
    said, question = "\n".join(found.statement), made["question"]
    if "goal" in question:
        assert "at the end: within " + repr(question["goal"]["radius_m"]) in said
        assert "steps 8 to 10" in said
    if "speed_limit" in question:
        assert f"speed: at most {question['speed_limit']['most_m_s']!r} m/s" in said
    if kind == "box":
        assert f"+- {made['start']['position_half_width_m']} m" in said


@pytest.mark.parametrize(
    ("kind", "verdict"), [("both", "GO"), ("both", "NO_GO"), ("box", "GO"), ("box", "NO_GO")]
)
def test_what_is_not_read_is_refused(kind: str, verdict: str) -> None:
    assert_all_is_read(check, document(kind, verdict), without=("speed_limit",))
    assert_every_digit_counts(check, document(kind, verdict), 60)


GOAL, SPEED = ("question", "goal"), ("question", "speed_limit")


@pytest.mark.parametrize(
    ("kind", "path", "easier", "harder"),
    [
        ("synchronize", (*GOAL, "radius_m"), 30.0, 0.01),
        ("synchronize", (*GOAL, "rest_m_s"), 1e3, 0.001),
        ("speed", (*SPEED, "most_m_s"), 30.0, 0.2),
        ("box", ("start", "position_half_width_m"), 0.1, 40.0),
        ("box", ("start", "velocity_half_width_m_s"), 0.1, 90.0),
    ],
)
def test_a_harder_go_and_an_easier_no_go_are_refused(
    kind: str, path: tuple[str, ...], easier: float, harder: float
) -> None:
    """And the other way round a box that grows is harder for a GO, and easier for no NO_GO."""
    assert refused(check, document(kind, "GO"), path, harder)
    assert not refused(check, document("box", "GO"), ("start", "position_half_width_m"), 0.5)
    if kind == "box":
        assert refused(check, document(kind, "NO_GO"), path, harder)
    elif kind == "speed":
        assert refused(check, document(kind, "NO_GO"), path, easier)


@pytest.mark.parametrize("key", ["position_half_width_m", "velocity_half_width_m_s"])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_box_counts_along_every_axis(key: str, axis: int) -> None:
    made = document("box", "GO")
    assert refused(check, made, ("start", key, axis), 1e3 if made["start"][key][axis] else 1.0)


@pytest.mark.parametrize("kind", ["synchronize", "both"])
def test_ends_are_checked(kind: str) -> None:
    made = document(kind, "GO")
    for path, value in (
        ((*GOAL, "hold_m"), [e + 50.0 for e in made["question"]["goal"]["hold_m"]]),
        (("question", "earliest_step"), 11),
        (("question", "earliest_step"), 0),
        (("thrust_m_s2" if "thrust_m_s2" in made else "throttle",), []),
    ):
        forged = copy.deepcopy(made)
        put(forged, path, value)
        with pytest.raises(ProofRejected):
            check(sealed(forged))
    made = document(kind, "NO_GO")
    # A part that is missing leaves its ends open.
    first = made["parts"][0]
    assert first["first_step"] == 8
    for change in ({"first_step": 9}, {"last_step": 11}, {"multipliers": []}):
        forged = copy.deepcopy(made)
        forged["parts"][0] |= change
        with pytest.raises(ProofRejected):
            check(sealed(forged))
    for row in first["multipliers"]:
        if "pull" in row:
            forged = copy.deepcopy(made)
            at = first["multipliers"].index(row)
            forged["parts"][0]["multipliers"][at]["pull"] = [2.0 * row["value"], 0.0, 0.0]
            with pytest.raises(ProofRejected, match="pull"):
                check(sealed(forged))


def test_a_flight_that_is_too_fast_or_ends_elsewhere_is_refused() -> None:
    question, state, _ = wide(4, 8)
    question = replace(question, goal=replace(question.goal, earliest=1))
    still = np.zeros((8, question.channels))
    far = replace(question, faces=tuple(replace(f, offset=f.offset + 1e4) for f in question.faces))
    answer = Answer(Verdict.GO, 1e-3, 1e-3, 1e-3, still, (), 1)
    with pytest.raises(ProofRejected, match="margin of"):
        check(json.loads(json.dumps(proof_in_space(far, state, answer))))
    fast = replace(far, goal=None, speed_limit=0.5 * float(np.linalg.norm(state[3:])))
    with pytest.raises(ProofRejected, match="speed"):
        check(json.loads(json.dumps(proof_in_space(fast, state, answer))))
    # The start is too fast by this: any multiplier that says more is refused.
    pull = tuple((0.999999 * state[3:] / np.linalg.norm(state[3:])).tolist())
    for claim, holds in ((-0.4, True), (-0.6, False)):
        upper = claim * 10.0 * float(np.linalg.norm(state[3:]))
        row = (Multiplier(0.0, "speed", 1.0, pull),)
        made = proof_in_space(fast, state, Answer(Verdict.NO_GO, upper, upper, upper, None, row, 0))
        if holds:
            assert check(json.loads(json.dumps(made))).verdict == "NO_GO"
        else:
            with pytest.raises(ProofRejected, match="sum of weighted"):
                check(json.loads(json.dumps(made)))
