"""Faces may have any name that the question takes: its proof is then accepted, whatever else has names elsewhere."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from safestart.attitude.spin import Spin
from safestart.constraints.thrust_limit import ball
from safestart.errors import InvalidInput
from safestart.exact.question import Goal
from safestart.exact.space.decide import decide_in_space
from safestart.exact.space.demands.rules import NONE, Demands
from safestart.exact.space.prove import proof_in_space
from safestart.exact.space.question import OTHERS, Face, SpaceQuestion
from safestart.proofs.checker import check
from tests.unit.exact.test_space_demands import PANEL, RULE, VIEW, question
from tests.unit.proofs.forgery import sealed

ASKED: dict[str, tuple[Demands, dict[str, Any]]] = {
    "stay": (NONE, {}),
    "speed": (NONE, {"speed_limit": 0.4}),
    "synchronize": (NONE, {"goal": Goal(hold=(0.0, 40.0, 0.0), radius=2.0, rest=0.2)}),
    "demands": (Demands((PANEL,), VIEW, RULE), {}),
}
FAR, NEAR = np.array([0.0, 60.0, 0.0, 0.0, 0.0, 0.0]), np.array([0.0, 40.0, 0.0, 0.0, 0.0, 0.0])


def asked(kind: str, name: str, a_max: float) -> SpaceQuestion:
    """Between two faces, of which one has the name; and behind a third one, which has another."""
    demands, more = ASKED[kind]
    faces = (
        Face(name, (1.0, -1.0, 0.0), 1.0, "body"),
        Face("b", (-1.0, -1.0, 0.0), 1.0, "body"),
        Face("c", (0.0, -1.0, 0.0), -1.0, "body"),
    )
    return question(demands, faces=faces, attitude=Spin(0.02), thrust=ball(a_max), steps=30, **more)


@pytest.mark.parametrize("name", sorted(OTHERS))
@pytest.mark.parametrize("kind", sorted(ASKED))
def test_names_of_what_is_beside_faces_are_refused(kind: str, name: str) -> None:
    """Whether or not the question has it: a NO_GO with a face ``hold`` had a proof that nobody accepted."""
    with pytest.raises(InvalidInput, match="names other than field_of_view, hold, plume, rest, speed"):
        asked(kind, name, 0.2)


@pytest.mark.parametrize("name", ["start", "thrust", "range", "margin_m", "Hold", "\u00fc {}"])
@pytest.mark.parametrize("kind", sorted(ASKED))
def test_what_is_proved_is_accepted(kind: str, name: str) -> None:
    verdicts = []
    for a_max, start in ((0.2, NEAR), (0.005, FAR)):
        one = asked(kind, name, a_max)
        answer = decide_in_space(one, start)
        verdicts.append(answer.verdict.value)
        if answer.verdict.value != "UNDECIDED":
            document = json.loads(json.dumps(proof_in_space(one, start, answer)))
            assert check(document).verdict == answer.verdict.value
    assert "NO_GO" in verdicts


@pytest.mark.parametrize("name", ["hold", "rest"])
def test_the_checker_reads_such_a_face_where_nothing_else_has_its_name(name: str) -> None:
    one = asked("stay", "other", 0.005)
    made = json.dumps(proof_in_space(one, FAR, decide_in_space(one, FAR)))
    assert '"other"' in made
    document = sealed(json.loads(made.replace('"other"', f'"{name}"')))
    assert check(document).verdict == "NO_GO"
