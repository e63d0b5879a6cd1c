"""Proof documents: valid ones verify, every harmful change is refused with the inequality that fails."""

import json
import math
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Question
from safestart.model.scenario import Chaser, CorridorShape, Scenario, Target
from safestart.proofs.single import check
from safestart.proofs.strict import ProofRejected
from tests.unit.proofs.forgery import Change, assert_every_digit_counts, assert_refused, changed

STARTS = {
    2: {"GO": [12.0, 45.0, 0.3, -0.4], "NO_GO": [-30.0, 120.0, 0.0, 0.2]},
    3: {"GO": [12.0, 45.0, 4.0, 0.3, -0.4, 0.1], "NO_GO": [-30.0, 120.0, 9.0, 0.0, 0.2, 0.5]},
}


def document(verdict: str, dimensions: int = 2, scenario: Scenario | None = None) -> dict[str, Any]:
    question = Question(scenario or Scenario.of(3.0, 0.1), dimensions=dimensions)
    state = np.array(STARTS[dimensions][verdict])
    answer = decide(question, state)
    assert answer.verdict.value == verdict
    made: dict[str, Any] = json.loads(json.dumps(proof_of(question, state, answer)))
    assert abs(made["margin_m"] - answer.margin_m) < 1e-6
    return made


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("verdict", ["GO", "NO_GO"])
def test_valid_proofs(verdict: str, dimensions: int) -> None:
    made = document(verdict, dimensions)
    verified = check(made)
    assert (verified.verdict, verified.margin_m) == (verdict, made["margin_m"])
    assert math.copysign(1.0, verified.margin_m) == (1.0 if verdict == "GO" else -1.0)


@pytest.mark.parametrize(("steps", "dt"), [(1, 3600.0), (10, 300.0), (100, 0.5)])
def test_long_and_short_steps(steps: int, dt: float) -> None:
    for dimensions, rate in ((2, 1.0), (3, 0.02)):
        question = Question(Scenario.of(rate, 0.1), dt, steps, dimensions)
        state = np.zeros(2 * dimensions)
        state[:2] = 3.0, 40.0
        answer = decide(question, state)
        assert check(proof_of(question, state, answer)).verdict == answer.verdict.value


@pytest.mark.parametrize("mean_motion", [0.0, 1e-12, 1.3e-3])
@pytest.mark.parametrize("rate", [0.0, 0.02])
def test_limits_of_the_motion(mean_motion: float, rate: float) -> None:
    scenario = Scenario(Target(rate, mean_motion), Chaser(0.1), CorridorShape(1.2, 0.7, 3.0, 2.0, 1.0))
    check(document("GO", 3, scenario))


def _thrust(made: dict[str, Any]) -> None:
    """Full thrust towards the face that the flight comes closest to, at the beginning."""
    made["thrust_m_s2"][0] = [0.0999, 0.0]


def _too_much(made: dict[str, Any]) -> None:
    """Beyond the disk by 2e-17 m/s^2: in floats the norm is a_max."""
    made["thrust_m_s2"][7] = [0.1, 2e-9]


def _claim(made: dict[str, Any]) -> None:
    made["margin_m"] += 1e-5 if made["verdict"] == "GO" else -1e-5


def _faster(made: dict[str, Any]) -> None:
    made["question"]["tumble_rate_rad_s"] *= 1.01 if made["verdict"] == "GO" else 0.9


def _weaker(made: dict[str, Any]) -> None:
    made["question"]["max_acceleration_m_s2"] *= 0.9 if made["verdict"] == "GO" else 1.001


def _start(made: dict[str, Any]) -> None:
    made["start"]["position_m"][0] += 0.01 if made["verdict"] == "GO" else -0.5


def _multiplier(made: dict[str, Any]) -> None:
    row = min(made["multipliers"], key=lambda r: r["value"])
    row["value"] += 0.2


def _negative(made: dict[str, Any]) -> None:
    made["multipliers"][0]["value"] = -1e-9


def _other_verdict(made: dict[str, Any]) -> None:
    made["verdict"] = "NO_GO" if made["verdict"] == "GO" else "GO"


@pytest.mark.parametrize(
    ("verdict", "change", "said"),
    [
        ("GO", _thrust, "distance to"),
        ("GO", _too_much, "a_max"),
        ("GO", _claim, "distance to"),
        ("GO", _faster, "distance to"),
        ("GO", _weaker, "a_max"),
        ("GO", _start, "distance to"),
        ("GO", _other_verdict, "multipliers"),
        ("NO_GO", _multiplier, "bound is"),
        ("NO_GO", _negative, "value"),
        ("NO_GO", _claim, "bound is"),
        ("NO_GO", _faster, "bound is"),
        ("NO_GO", _weaker, "bound is"),
        ("NO_GO", _start, "bound is"),
        ("NO_GO", _other_verdict, "thrust_m_s2"),
    ],
)
def test_harmful_changes(verdict: str, change: Change, said: str) -> None:
    assert_refused(check, document(verdict), change, said)


@pytest.mark.parametrize("verdict", ["GO", "NO_GO"])
def test_a_digit_anywhere(verdict: str) -> None:
    assert_every_digit_counts(check, document(verdict), 60)


MALFORMED: list[tuple[str, Any]] = [
    ("schema", "safestart-proof/2"),
    ("verdict", ["GO"]),
    ("verdict", "UNDECIDED"),
    ("margin_m", None),
    ("margin_m", True),
    ("margin_m", -1.0),
    ("thrust_m_s2", None),
    ("thrust_m_s2", [[0.0, 0.0]]),
    ("thrust_m_s2", [[0.0]] * 30),
    ("thrust_m_s2", [["0", 0.0]] * 30),
    ("start", []),
    ("start", {"position_m": [1.0, 2.0]}),
    ("question", 3),
    ("question.kind", "leave"),
    ("question.steps", 10**9),
    ("question.steps", 3.0),
    ("question.dimensions", 1),
    ("question.dt_s", 0.0),
    ("question.dt_s", 1e300),
    ("question.corridor", None),
    ("question.corridor.c_x", "1.5"),
    ("question.tumble_rate_rad_s", -1.0),
    ("question.mean_motion_rad_s", 10**400),
]


@pytest.mark.parametrize(("key", "value"), MALFORMED)
def test_malformed(key: str, value: Any) -> None:
    with pytest.raises(ProofRejected):
        check(changed(GO, key, value))


GO = document("GO")
NO_GO = document("NO_GO")


@pytest.mark.parametrize(
    "rows",
    [
        [],
        [3],
        [{"time_s": 61.0, "face": "left", "value": 1.0}],
        [{"time_s": 1.0, "face": "top", "value": 1.0}],
        [{"time_s": 1.0, "face": ["left"], "value": 1.0}],
        [{"time_s": 1.0, "face": "left", "value": 0.0}],
        [{"time_s": 1.0, "face": "left"}],
    ],
)
def test_malformed_multipliers(rows: Any) -> None:
    with pytest.raises(ProofRejected):
        check(changed(NO_GO, "multipliers", rows))


@pytest.mark.parametrize("other", [None, [], "proof", 3, {}, {"schema": "safestart-proof/1", "x": math.nan}])
def test_not_a_document(other: Any) -> None:
    with pytest.raises(ProofRejected):
        check(other)


def test_undecided_proves_nothing() -> None:
    question = Question(Scenario.of(0.0, 0.1))
    state = np.array([0.0, 0.5, 0.0, 0.0])
    answer = decide(question, state)
    assert answer.verdict is Verdict.UNDECIDED
    with pytest.raises(InvalidInput):
        proof_of(question, state, answer)


def test_verify_command(tmp_path: Any) -> None:
    run, app, path = CliRunner(), build(), tmp_path / "proof.json"
    for made in (GO, NO_GO):
        path.write_text(json.dumps(made))
        done = run.invoke(app, ["verify", str(path)])
        assert done.exit_code == 0
        assert made["verdict"] in done.stdout
        answer = json.loads(run.invoke(app, ["verify", str(path), "--json"]).stdout)
        assert answer["valid"]
        assert answer["margin_m"] == made["margin_m"]
    done = run.invoke(app, ["verify", "-", "--json"], input=json.dumps(GO | {"margin_m": 80.0}))
    assert done.exit_code == 1
    assert not json.loads(done.stdout)["valid"]
    path.write_text("{")
    assert run.invoke(app, ["verify", str(path)]).exit_code == 2
    assert run.invoke(app, ["verify", str(tmp_path / "none.json")]).exit_code == 2
