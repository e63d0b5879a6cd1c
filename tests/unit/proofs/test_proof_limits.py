"""Proofs of synchronize and of the speed limit: every harmful change is refused with the inequality that fails."""

import copy
import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.model.scenario import Scenario
from safestart.proofs.single import check
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected

STARTS = {"GO": [6.0, 16.0, 0.1, -0.2], "NO_GO": [8.0, 48.0, 0.0, -0.1]}


def document(verdict: str) -> dict[str, Any]:
    question = Question(Scenario.of(3.0, 0.05), 2.0, 30, 2, Goal(), 0.8, 0.5)
    state = np.array(STARTS[verdict])
    answer = decide(question, state)
    assert answer.verdict.value == verdict
    made: dict[str, Any] = json.loads(json.dumps(proof_of(question, state, answer)))
    check(made)
    return made


GO, NO_GO = document("GO"), document("NO_GO")


def rows(made: dict[str, Any], face: str) -> list[dict[str, Any]]:
    return [row for part in made["parts"] for row in part["multipliers"] if row["face"] == face]


def _thrust(made: dict[str, Any]) -> None:
    """The last push changes the end alone, where the margin is the ball's and the rest's."""
    made["thrust_m_s2"][-1][0] += 0.02


def _shorter(made: dict[str, Any]) -> None:
    made["thrust_m_s2"].pop()


def _longer(made: dict[str, Any]) -> None:
    made["thrust_m_s2"] += [[0.0, 0.0]] * 31


def _claim(made: dict[str, Any]) -> None:
    made["margin_m"] += 1e-5 if made["verdict"] == "GO" else -1e-5


def _weaker(made: dict[str, Any]) -> None:
    made["question"]["max_acceleration_m_s2"] *= 0.5 if made["verdict"] == "GO" else 3.0


def _turn(made: dict[str, Any]) -> None:
    made["question"]["tumble_rate_rad_s"] *= 1.05 if made["verdict"] == "GO" else 0.2


def _ball(made: dict[str, Any]) -> None:
    made["question"]["goal"]["radius_m"] *= 0.5 if made["verdict"] == "GO" else 100.0


def _point(made: dict[str, Any]) -> None:
    made["question"]["goal"]["hold_m"][1] += 0.6 if made["verdict"] == "GO" else 60.0


def _rest(made: dict[str, Any]) -> None:
    made["question"]["goal"]["rest_m_s"] *= 0.4


def _slower(made: dict[str, Any]) -> None:
    made["question"]["speed_limit"]["most_m_s"] = 0.5


def _at_once(made: dict[str, Any]) -> None:
    made["question"]["earliest_step"] = 0


def _later(made: dict[str, Any]) -> None:
    made["question"]["earliest_step"] = len(made["thrust_m_s2"]) + 1
    made["question"]["steps"] = len(made["thrust_m_s2"]) + 1


def _more_ends(made: dict[str, Any]) -> None:
    made["question"]["steps"] += 1


def _gap(made: dict[str, Any]) -> None:
    made["parts"][0]["first_step"] += 1


def _beyond(made: dict[str, Any]) -> None:
    made["parts"][-1]["last_step"] += 1


def _pull(made: dict[str, Any]) -> None:
    """Longer than the weight: the cone is left by a part in 10^9."""
    row = max(rows(made, "hold"), key=lambda r: r["value"])
    size = math.hypot(*row["pull"])
    row["pull"] = [e * row["value"] / size * (1.0 + 1e-9) for e in row["pull"]]


def _aside(made: dict[str, Any]) -> None:
    for row in rows(made, "hold") + rows(made, "rest"):
        row["pull"] = [-e for e in row["pull"]]


def _weight(made: dict[str, Any]) -> None:
    for row in rows(made, "hold"):
        row["value"] *= 30.0


def _keep_out(made: dict[str, Any]) -> None:
    made["question"]["keep_out_m"] = 0.5000001


CHANGES: list[tuple[dict[str, Any], Callable[[dict[str, Any]], None], str]] = [
    (GO, _thrust, "margin of (hold|rest)"),
    (GO, _shorter, "margin of (hold|rest)|distance"),
    (GO, _longer, "thrusts"),
    (GO, _claim, "margin of|distance to"),
    (GO, _weaker, "a_max"),
    (GO, _turn, "margin of|distance to"),
    (GO, _ball, "margin of (hold|rest)"),
    (GO, _point, "margin of hold"),
    (GO, _rest, "margin of rest"),
    (GO, _slower, "margin of speed"),
    (GO, _at_once, "earliest_step"),
    (GO, _later, "thrusts"),
    (GO, _keep_out, "keep_out_m"),
    (NO_GO, _claim, "bound is"),
    (NO_GO, _weaker, "bound is"),
    (NO_GO, _turn, "bound is"),
    (NO_GO, _ball, "bound is"),
    (NO_GO, _point, "bound is"),
    (NO_GO, _more_ends, "parts"),
    (NO_GO, _gap, "parts"),
    (NO_GO, _beyond, "parts"),
    (NO_GO, _pull, "pull"),
    (NO_GO, _aside, "bound is"),
    (NO_GO, _weight, "bound is"),
]


@pytest.mark.parametrize(("made", "change", "said"), CHANGES)
def test_harmful_changes(made: dict[str, Any], change: Callable[[dict[str, Any]], None], said: str) -> None:
    changed = copy.deepcopy(made)
    change(changed)
    with pytest.raises(ProofRejected, match="digest"):
        check(changed)
    with pytest.raises(ProofRejected, match=said):
        check(changed | {"digest": digest_of(changed)})


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("goal", None),
        ("goal", {"hold_m": [0.0], "radius_m": 0.5, "rest_m_s": 0.05}),
        ("goal", {"hold_m": [0.0, 0.5], "radius_m": -0.5, "rest_m_s": 0.05}),
        ("goal", {"hold_m": [0.0, 0.5], "radius_m": 0.5, "rest_m_s": 0.0}),
        ("speed_limit", 0.8),
        ("speed_limit", {"most_m_s": 0.8}),
        ("keep_out_m", "0"),
        ("earliest_step", None),
        ("earliest_step", True),
    ],
)
def test_malformed_limits(key: str, value: Any) -> None:
    made = copy.deepcopy(GO)
    made["question"][key] = value
    with pytest.raises(ProofRejected):
        check(made | {"digest": digest_of(made)})


@pytest.mark.parametrize(
    "part",
    [
        3,
        {"first_step": 1, "last_step": 30},
        {"first_step": 1, "last_step": 30, "multipliers": []},
        {
            "first_step": 1.0,
            "last_step": 30,
            "multipliers": [{"face": "hold", "value": 1.0, "pull": [0.0, 1.0]}],
        },
        {"first_step": 1, "last_step": 30, "multipliers": [{"face": "hold", "value": 1.0}]},
        {"first_step": 1, "last_step": 30, "multipliers": [{"face": "left", "value": 1.0}]},
        {"first_step": 1, "last_step": 30, "multipliers": [{"face": "rest", "value": 1.0, "pull": [0.0]}]},
    ],
)
def test_malformed_parts(part: Any) -> None:
    made = copy.deepcopy(NO_GO) | {"parts": [part]}
    with pytest.raises(ProofRejected):
        check(made | {"digest": digest_of(made)})


def test_limits_that_are_not_asked_for_prove_nothing() -> None:
    """Multipliers of the ball refute `synchronize`, not `stay`; a witness of one question is none of the other."""
    made = copy.deepcopy(NO_GO)
    made["question"]["kind"] = "stay"
    made["multipliers"] = made.pop("parts")[-1]["multipliers"]
    del made["question"]["goal"], made["question"]["earliest_step"]
    with pytest.raises(ProofRejected, match="face of the question"):
        check(made | {"digest": digest_of(made)})
    made = copy.deepcopy(NO_GO)
    del made["question"]["speed_limit"]
    if rows(made, "speed"):
        with pytest.raises(ProofRejected, match="face of the question"):
            check(made | {"digest": digest_of(made)})


def test_the_speed_limit_counts_the_speed_out_of_the_plane() -> None:
    """A free drift at 0.5 m/s along z: proved below 0.8 m/s, refused at 0.4 m/s, though it stands in the plane."""
    question = Question(Scenario.of(1.0, 0.05), 2.0, 2, 3, None, 0.8)
    state = np.array([0.0, 40.0, 0.0, 0.0, 0.0, 0.5])
    made = json.loads(json.dumps(proof_of(question, state, decide(question, state))))
    made["thrust_m_s2"], made["margin_m"] = [[0.0, 0.0, 0.0]] * 2, 0.1
    made["digest"] = digest_of(made)
    assert check(made).verdict == "GO"
    made["question"]["speed_limit"]["most_m_s"] = 0.4
    made["digest"] = digest_of(made)
    with pytest.raises(ProofRejected, match="speed"):
        check(made)
