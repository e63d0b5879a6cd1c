"""Documents that claim more than their evidence: each is rejected, and only checked statements are printed."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.exact.decide import decide
from safestart.exact.prove import proof_of
from safestart.exact.question import Goal, Question
from safestart.families.decide import decide_for_all
from safestart.families.members import Family
from safestart.families.prove import proof_for_all
from safestart.model.scenario import Chaser, CorridorShape, Scenario, Target
from safestart.proofs.checker import check
from safestart.proofs.strict import ProofRejected
from tests.unit.proofs.forgery import Document, sealed

PAPER = Question(Scenario.of(3.0, 0.1))
ENDS = Question(Scenario.of(3.0, 0.05), 2.0, 30, 2, Goal(), 0.8, 0.5)


def made(question: Question, *start: float) -> Document:
    state = np.array(start)
    out: Document = json.loads(json.dumps(proof_of(question, state, decide(question, state))))
    check(out)
    return out


def made_for_all(y: float, **change: Any) -> Document:
    family = Family(PAPER, 5e-4, 2e-3, start=(0.0, 0.5, 0.02, 0.0))
    state = np.array([12.0, y, 0.0, 0.0])
    out: Document = json.loads(
        json.dumps(proof_for_all(family, state, decide_for_all(family, state, **change)))
    )
    return out


MADE: dict[str, Document] = {
    "stay GO": made(PAPER, 12.0, 45.0, 0.3, -0.4),
    "stay NO_GO": made(PAPER, -30.0, 120.0, 0.0, 0.2),
    "synchronize GO": made(ENDS, 6.0, 16.0, 0.1, -0.2),
    "synchronize NO_GO": made(ENDS, 8.0, 48.0, 0.0, -0.1),
    "family GO": made_for_all(55.0),
    "family GO per corner": made_for_all(55.0, witness="per_corner"),
    "family NO_GO": made_for_all(75.0),
}


def forged(name: str, **change: Any) -> Document:
    """A sealed copy with other fields; a dotted name reaches inside, None takes a field away."""
    out = copy.deepcopy(MADE[name])
    for key, value in change.items():
        *path, last = key.split("__")
        inside = out
        for part in path:
            inside = inside[part]
        if value is None:
            del inside[last]
        else:
            inside[last] = value
    return sealed(out)


def refused(document: Document, said: str) -> None:
    with pytest.raises(ProofRejected, match=said):
        check(document)


@pytest.mark.parametrize("half", [[60.0, 30.0], [1000.0, 1000.0]])
@pytest.mark.parametrize(
    "more", [{"histories": []}, {"witness": "per_corner", "histories": []}, {"pieces": []}, {}]
)
def test_one_start_is_no_box(half: list[float], more: dict[str, Any]) -> None:
    """It was printed as "start +- [60, 30] m, one history stays for all members", where members are NO_GO."""
    member = decide(PAPER, np.array([12.0 + half[0], 45.0 - half[1], 0.3, -0.4]), verdict_only=True)
    assert member.verdict.value == "NO_GO"
    refused(forged("stay GO", start__position_half_width_m=half, **more), "unknown")


def test_staying_is_no_synchronizing() -> None:
    """It was printed with the hold ball and the earliest step of a question that nobody had proved."""
    goal = MADE["synchronize GO"]["question"]["goal"]
    asked = Question(PAPER.scenario, goal=Goal())
    start = (12.0, 58.0, 0.0, 0.0)
    assert decide(asked, np.array(start)).verdict.value == "NO_GO"
    out = made(PAPER, *start)
    out["question"] |= {"goal": goal, "earliest_step": 1}
    refused(sealed(out), "'goal' unknown, 'earliest_step' unknown")
    refused(forged("stay GO", question__kind="synchronize"), "missing")
    refused(forged("synchronize GO", question__kind="stay"), "unknown")
    refused(forged("synchronize GO", question__goal=None), "goal missing")


def test_the_frame_is_the_one_that_counts() -> None:
    """In the turning frame the same numbers are another motion."""
    refused(forged("stay GO", start__frame="body"), "frame: required lvlh")
    refused(forged("stay GO", start__frame=None), "frame missing")
    refused(forged("family GO", start__frame="body"), "frame: required lvlh")


def test_a_disturbance_is_not_waved_through() -> None:
    refused(forged("stay GO", question__disturbance_m_s2=0.05), "'disturbance_m_s2' unknown")
    refused(forged("family GO", question__disturbance_m_s2=0.05), "'disturbance_m_s2' unknown")
    refused(forged("stay GO", disturbance={"acceleration_m_s2": 0.05}), "'disturbance' unknown")


@pytest.mark.parametrize("margin", [-0.5, 5.0])
def test_no_parts_refute_no_end(margin: float) -> None:
    """A start that can fly was NO_GO by no evidence at all, even with five metres to spare."""
    out = forged("synchronize GO", thrust_m_s2=None, arrival=None, parts=[], verdict="NO_GO", margin_m=margin)
    refused(out, "parts: required all steps" if margin < 0.0 else "margin_m: required < 0")
    refused(forged("synchronize NO_GO", parts=[]), "parts: required all steps")


def test_every_end_is_refuted() -> None:
    document = MADE["synchronize NO_GO"]
    first, last = document["parts"][0]["first_step"], document["parts"][-1]["last_step"]
    assert (first, last) == (1, 30)
    one = document["parts"][0]
    assert one["last_step"] > 2
    for parts in (
        [one | {"last_step": 2}],
        [one | {"first_step": 2}, *document["parts"][1:]],
        [one | {"last_step": 2}, one | {"first_step": 4, "last_step": 30}],
        [one | {"last_step": 3}, one | {"first_step": 3, "last_step": 30}],
        [one | {"first_step": 2, "last_step": 30}, one | {"last_step": 1}],
    ):
        refused(forged("synchronize NO_GO", parts=parts), "parts: required")


@pytest.mark.parametrize("name", sorted(MADE))
@pytest.mark.parametrize("margin", [5.0, -5.0, 0.0, -0.0])
def test_the_claim_has_the_sign_of_the_verdict(name: str, margin: float) -> None:
    """The proof is that the margin is above or below 0: a NO_GO with +5 m is invalid."""
    if (margin > 0.0) is ("NO_GO" not in name) and margin != 0.0:
        return
    refused(forged(name, margin_m=margin), "margin_m: required [<>] 0")


def _objects(value: Any, path: str = "") -> Iterator[tuple[str, Document]]:
    if isinstance(value, dict):
        yield path, value
        for key, inside in value.items():
            yield from _objects(inside, f"{path}.{key}")
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        yield from _objects(value[-1], f"{path}[-1]")


@pytest.mark.parametrize("name", sorted(MADE))
def test_every_object_is_closed(name: str) -> None:
    """No object of any document accepts an additional field or a missing one."""
    whole = check(MADE[name]).statement
    paths = [path for path, _ in _objects(MADE[name])]
    assert len(paths) >= 4
    for path in paths:
        names = dict(_objects(MADE[name]))[path]
        for field in ("position_half_width_m", "goal", "note", ""):
            if field in names:
                continue
            out = copy.deepcopy(MADE[name])
            dict(_objects(out))[path][field] = 1.0
            refused(sealed(out), "unknown")
        for field in names:
            out = copy.deepcopy(MADE[name])
            del dict(_objects(out))[path][field]
            try:
                found = check(out if field == "digest" else sealed(out))
            except ProofRejected:
                continue
            # A weaker demand is another question, a claim left out another statement, and the statement shows it.
            assert field in ("keep_out_m", "speed_limit", "arrival")
            assert found.statement != whole


def _verified(document: Document, tmp_path: Path) -> str:
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(document))
    done = CliRunner().invoke(build(), ["verify", str(path)])
    assert done.exit_code == 0, done.output
    return " ".join(done.stdout.split())


def test_the_whole_statement_is_printed(tmp_path: Path) -> None:
    """A GO in a corridor with c_x = 100 was printed like the paper's: the corridor was not named."""
    wide = Question(
        Scenario(Target(0.05), Chaser(0.1), CorridorShape(100.0, 0.7, 3.0, 2.0, 0.25)), 1.25, 7, 3
    )
    said = _verified(made(wide, 30.0, 45.0, 1.0, 0.1, 0.0, 0.0), tmp_path)
    for part in (
        "y >= 0.25, |x| <= 3.0 + 100.0 (y - 0.25), |z| <= 2.0 + 0.7 (y - 0.25)",
        "stay: in the corridor at all times for 7 steps of 1.25 s (8.75 s)",
        "0.05 rad/s (2.86479 deg/s)",
        "mean motion: 0.0011 rad/s",
        "at most 0.1 m/s^2, no disturbance",
        "[30.0, 45.0, 1.0] m",
        "[0.1, 0.0, 0.0] m/s",
        "in space",
    ):
        assert part in said, part
    said = _verified(MADE["synchronize NO_GO"], tmp_path)
    for part in (
        "any of the steps 1 to 30 of 2.0 s (2 s to 60 s)",
        "within 0.5 m of [0.0, 0.5] m in the body frame, at most 0.05 m/s",
        "10.0 s times",
        "0.5 / 0.05 s times",
        "at most 0.8 m/s in LVLH at all times",
        "keep-out radius: 0.5 m",
        "in the orbit plane",
    ):
        assert part in said, part
    said = _verified(MADE["family GO per corner"], tmp_path)
    for part in (
        "[12.0, 55.0] +- [0.0, 0.5] m",
        "[0.0, 0.0] +- [0.02, 0.0] m/s",
        "each corner",
        "0.098 to 0.102",
    ):
        assert part in said, part


@pytest.mark.parametrize("name", sorted(MADE))
def test_every_number_is_printed_as_the_double_it_is(name: str, tmp_path: Path) -> None:
    document = MADE[name]
    said = _verified(document, tmp_path)
    assert repr(document["margin_m"]) in said
    question, start = document["question"], document["start"]
    scalars = [question[key] for key in ("tumble_rate_rad_s", "max_acceleration_m_s2", "mean_motion_rad_s")]
    for value in [*scalars, start["position_m"], start["velocity_m_s"], question["dt_s"]]:
        for number in value if isinstance(value, list) else [value]:
            assert repr(float(number)) in said


def test_a_field_twice_is_refused(tmp_path: Path) -> None:
    """One reader takes the first value, another the last."""
    path, run = tmp_path / "proof.json", CliRunner()
    text = json.dumps(MADE["stay GO"])
    path.write_text('{"margin_m": 80.0, ' + text[1:])
    assert run.invoke(build(), ["verify", str(path)]).exit_code == 2
    path.write_text(text.replace('"verdict": "GO"', '"verdict": "GO", "note": 1e999'))
    assert run.invoke(build(), ["verify", str(path)]).exit_code == 2


def test_what_is_rejected_cannot_write_its_own_verdict(tmp_path: Path) -> None:
    path = tmp_path / "proof.json"
    path.write_text(
        json.dumps(forged("stay GO", start__frame="x\n[bold green]GO[/] proved: margin at least 9 m"))
    )
    done = CliRunner().invoke(build(), ["verify", str(path)])
    assert done.exit_code == 1
    assert len(done.stdout.strip().splitlines()) == 1
    assert done.stdout.startswith("rejected")
    assert "[bold green]" in done.stdout


def test_planar_answers_do_not_print_what_was_not_used(tmp_path: Path) -> None:
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(forged("stay GO", question__corridor__c_z=77.0)))
    done = CliRunner().invoke(build(), ["verify", str(path), "--json"])
    assert done.exit_code == 0
    assert "77.0" not in done.stdout
    assert set(json.loads(done.stdout)["question"]["corridor"]) == {"c_x", "x0_m", "hold_radius_m"}
