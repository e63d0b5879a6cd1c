"""Proofs against a disturbance: the tube is checked with the plan, and every harmful change is refused."""

from __future__ import annotations

import copy
import json
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.disturbance.prove import proof_against
from safestart.disturbance.tube import Disturbance, Verdict, decide_disturbed, tube_of
from safestart.errors import InvalidInput
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.model.scenario import Chaser, CorridorShape, Scenario, Target
from safestart.proofs.checker import check
from safestart.proofs.strict import ProofRejected
from tests.unit.proofs.forgery import Document, assert_every_digit_counts, changed, sealed

PLANE = Question(Scenario.of(2.0, 0.05), 2.0, 12)
SPACE = Question(Scenario(Target(0.02), Chaser(0.1), CorridorShape(1.2, 0.7, 3.0, 2.0, 1.0)), 1.0, 6, 3)


def made(question: Question, disturbance: Disturbance, *start: float) -> Document:
    state = np.array(start)
    answer = decide_disturbed(question, state, disturbance)
    assert answer.verdict is Verdict.GO
    document = proof_against(question, disturbance, tube_of(question, disturbance), state, answer)
    assert document["margin_m"] <= answer.lower
    out: Document = json.loads(json.dumps(document))
    return out


GO = made(PLANE, Disturbance(0.004, 0.3, 0.01), 5.0, 40.0, 0.0, 0.0)
DEEP = made(SPACE, Disturbance(0.01), 2.0, 12.0, 1.0, 0.1, 0.0, 0.0)


@pytest.mark.parametrize(
    ("question", "disturbance", "start"),
    [
        (PLANE, Disturbance(0.01), (5.0, 40.0, 0.0, 0.0)),
        (PLANE, Disturbance(0.0, 1.0, 0.0), (5.0, 40.0, 0.2, -0.1)),
        (PLANE, Disturbance(0.0, 0.0, 0.05), (5.0, 40.0, 0.2, -0.1)),
        (SPACE, Disturbance(0.005, 0.2, 0.02), (2.0, 12.0, 1.0, 0.1, 0.0, 0.0)),
        (Question(Scenario.of(0.1, 0.05), 20.0, 5), Disturbance(1e-4), (0.0, 60.0, 0.0, 0.0)),
        (Question(Scenario.of(2.0, 0.05, 0.0), 0.5, 20, 2, None, None, 0.4), Disturbance(0.002), (0.0, 9.0, 0.0, 0.0)),
        # Sides that meet above the hold plane once they have moved in.
        (Question(Scenario(Target(0.0), Chaser(0.1), CorridorShape(0.3, 0.3, 0.05, 0.05)), 1.0, 5),
         Disturbance(0.01), (0.0, 30.0, 0.0, 0.0)),
    ],
)  # fmt: skip
def test_every_go_has_a_proof_that_holds_the_tube(
    question: Question, disturbance: Disturbance, start: tuple[float, ...]
) -> None:
    document = made(question, disturbance, *start)
    verified = check(document)
    assert (verified.verdict, verified.margin_m) == ("GO", document["margin_m"])


def _stronger(document: Document) -> None:
    document["disturbance"]["acceleration_m_s2"] *= 1.5


def _farther(document: Document) -> None:
    document["disturbance"]["position_m"] += 3.0


def _faster(document: Document) -> None:
    document["disturbance"]["velocity_m_s"] += 1.0


def _narrower(document: Document) -> None:
    document["tube"]["radius_m"] *= 0.5


def _calmer(document: Document) -> None:
    document["tube"]["thrust_m_s2"] *= 0.5


def _flatter(document: Document) -> None:
    document["tube"]["height_m"] *= 0.3


def _slack(document: Document) -> None:
    """A feedback that does nothing asks for no thrust, and lets the error grow."""
    document["feedback"]["plane"] = [[0.0] * 4] * 2


def _wrong_way(document: Document) -> None:
    document["feedback"]["plane"] = [[-e for e in row] for row in document["feedback"]["plane"]]


def _all_thrust(document: Document) -> None:
    """The plan uses thrust that the feedback may need."""
    document["thrust_m_s2"][3] = [0.0, document["question"]["max_acceleration_m_s2"]]


def _wider(document: Document) -> None:
    """A tube as wide as you like holds everything, and leaves no corridor."""
    document["tube"]["radius_m"] *= 200.0


def _claim(document: Document) -> None:
    document["margin_m"] += 1e-5


def _weaker(document: Document) -> None:
    document["question"]["max_acceleration_m_s2"] *= 0.5


def _tighter(document: Document) -> None:
    """The tube was subtracted from the whole corridor, not from the rest of it."""
    document["question"]["corridor"]["hold_radius_m"] += 1.0
    document["question"]["corridor"]["c_x"] *= 0.1


CHANGES = [
    *((GO, change, "tube.(radius_m|thrust_m_s2)") for change in (_stronger, _farther, _faster, _slack, _wrong_way)),
    (GO, _narrower, "tube.radius_m"),
    (GO, _calmer, "tube.thrust_m_s2"),
    (GO, _all_thrust, "a_max"),
    (GO, _wider, "distance to"),
    (GO, _claim, "distance to"),
    (GO, _weaker, "a_max"),
    (GO, _tighter, "distance to"),
    (DEEP, _flatter, "tube.height_m"),
    (DEEP, _narrower, "tube.radius_m"),
    (DEEP, _stronger, "tube"),
    (DEEP, _claim, "distance to"),
]  # fmt: skip


@pytest.mark.parametrize(("document", "change", "said"), CHANGES)
def test_harmful_changes(document: Document, change: Any, said: str) -> None:
    out = copy.deepcopy(document)
    change(out)
    with pytest.raises(ProofRejected, match="digest"):
        check(out)
    with pytest.raises(ProofRejected, match=said):
        check(sealed(out))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("verdict", "NO_GO"),
        ("question.kind", "synchronize"),
        ("question.speed_limit", {"most_m_s": 1.0, "scale_s": 10.0}),
        ("question.dt_s", 61.0),
        ("start.frame", "body"),
        ("disturbance", None),
        ("disturbance.acceleration_m_s2", -0.001),
        ("disturbance.acceleration_m_s2", "0.004"),
        ("disturbance.torque_n_m", 1.0),
        ("feedback", []),
        ("feedback.plane", [[0.0] * 4]),
        ("feedback.plane", [[0.0] * 6] * 2),
        ("feedback.cross", [[0.0, 0.0]]),
        ("tube.radius_m", None),
        ("tube.radius_m", True),
        ("tube.height_m", 0.1),
        ("tube.thrust_m_s2", 1.0),
        ("multipliers", []),
        ("histories", []),
    ],
)
def test_malformed(key: str, value: Any) -> None:
    with pytest.raises(ProofRejected):
        check(changed(GO, key, value))


@pytest.mark.parametrize("name", ["disturbance", "feedback", "tube", "thrust_m_s2", "margin_m"])
def test_nothing_is_left_out(name: str) -> None:
    out = copy.deepcopy(GO)
    del out[name]
    with pytest.raises(ProofRejected, match=f"{name} missing"):
        check(sealed(out))


def test_a_digit_anywhere() -> None:
    assert_every_digit_counts(check, GO, 40)


def test_what_is_printed_names_disturbance_and_tightened_corridor(tmp_path: Any) -> None:
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(DEEP))
    done = CliRunner().invoke(build(), ["verify", str(path)])
    assert done.exit_code == 0, done.output
    said = " ".join(done.stdout.split())
    for part in (
        "an acceleration of at most 0.01 m/s^2 at all times",
        "within 0.0 m and 0.0 m/s of where it is believed",
        f"within {DEEP['tube']['radius_m']!r} m in the orbit plane and {DEEP['tube']['height_m']!r} m across it",
        f"at most {DEEP['tube']['thrust_m_s2']!r} m/s^2",
        "y >= 1.0, |x| <= 3.0 + 1.2 (y - 1.0), |z| <= 2.0 + 0.7 (y - 1.0)",
        "tightened corridor (rounded), m: y >= 1.0",
        "plan and feedback together",
    ):
        assert part in said, part
    assert "no disturbance" not in said


def test_a_plan_alone_says_nothing_of_a_disturbance() -> None:
    """The document of before: the plan in its own corridor, which it names; it still proves that."""
    disturbance = Disturbance(0.004)
    tube = tube_of(PLANE, disturbance)
    assert tube.question is not None
    state = np.array([5.0, 40.0, 0.0, 0.0])
    plan = check(proof_of(tube.question, state, decide_disturbed(PLANE, state, disturbance)))
    assert any("no disturbance" in line for line in plan.statement)
    assert any("y >= 0.6449" in line for line in plan.statement)


def test_a_no_go_is_the_plain_one_and_undecided_has_none() -> None:
    disturbance = Disturbance(0.004)
    far = np.array([9.364, 81.044, 0.0, 0.0])
    question = Question(Scenario.of(2.0, 0.05))
    answer = decide_disturbed(question, far, disturbance)
    document = proof_against(question, disturbance, tube_of(question, disturbance), far, answer)
    assert document == proof_of(question, far, answer)
    none = decide_disturbed(question, np.array([0.0, 86.0, 0.0, 0.0]), disturbance)
    assert none.verdict is Verdict.UNDECIDED
    with pytest.raises(InvalidInput):
        proof_against(question, disturbance, tube_of(question, disturbance), far, none)
