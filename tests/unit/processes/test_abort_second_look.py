"""passive-abort asks the independent checker about its own proof, within a budget, and believes it."""

from __future__ import annotations

import json
import math

import pytest

from safestart.missed_burn.document import document_of
from safestart.missed_burn.earth.motion import Earth
from safestart.missed_burn.plan import Errors, Failures, Question
from safestart.missed_burn.prove import prove
from safestart.processes.execute import execute
from safestart.processes.passive_abort import run, second_look
from safestart.processes.registry import process
from tests.unit.missed_burn.flights import ORBIT, plan_of
from tests.unit.processes.boasted import boasted

EXAMPLE = {**process("passive-abort").example, "error_level": False}


def _made(**more):
    done = execute("passive-abort", {**EXAMPLE, **more})
    return done.document["outputs"], {artifact.name: artifact for artifact in done.artifacts}


def test_a_proof_is_checked_before_it_is_handed_out() -> None:
    said, files = _made()
    assert (said["verdict"], said["checked"]) == ("PROVED", True)
    assert json.loads(files["proof.json"].data)["least_distance_m"] == said["least_distance_m"]


def test_without_a_proof_nothing_is_checked() -> None:
    said, files = _made(keep_out_m=120)
    assert (said["verdict"], said["checked"]) == ("VIOLATED", None)
    assert "proof.json" not in files


def test_a_proof_that_the_checker_refuses_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "document_of", boasted)
    said, files = _made(error_level=True)
    assert (said["verdict"], said["checked"]) == ("UNKNOWN", True)
    assert said["least_distance_m"] == 0.0
    assert said["gap_m"] == EXAMPLE["keep_out_m"]
    assert said["error_level"] is None
    assert {case["least_distance_m"] for case in said["cases"]} == {0.0}
    assert any("short by" in note for note in said["notes"])
    assert set(files) == {"aborts.png"}


def test_a_proof_beyond_the_budget_says_that_it_was_not_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(second_look, "BUDGET", 0.0)
    said, files = _made()
    assert (said["verdict"], said["checked"]) == ("PROVED", False)
    assert any("checked: false" in note for note in said["notes"])
    assert "proof.json" in files


def test_the_estimate_grows_with_what_the_checker_has_to_do() -> None:
    plan = plan_of(90.0, 2, 1000.0)

    def estimated(horizon: float, failures: Failures, *, earth: bool) -> float:
        about = Earth.of(plan, 8.1e6) if earth else None
        proof = prove(Question(plan, 1.0, horizon, Errors(), failures, earth=about), sharp=False)
        return second_look.seconds_of(document_of(proof))

    missed, weak = Failures(), Failures(partial=True)
    short = estimated(600.0, missed, earth=False)
    assert short < estimated(600.0, weak, earth=False) < 0.2
    assert short < estimated(600.0, missed, earth=True) < estimated(600.0, weak, earth=True)
    # An enclosed course is what takes long: of the target, and near two references of each burn and one of the start.
    more = estimated(2.0 * ORBIT, weak, earth=True) - estimated(ORBIT, weak, earth=True)
    assert more >= 5.9 * second_look._ORBIT
    assert math.isfinite(more)
