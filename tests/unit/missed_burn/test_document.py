"""Documents of the missed-burn proof: accepted as made, refused when anything is bent, and every term of it counts."""

import json
import math
from itertools import pairwise

import numpy as np
import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.errors import Conflict
from safestart.missed_burn.cases import cases_of
from safestart.missed_burn.document import document_of
from safestart.missed_burn.plan import Errors, Failures, Question
from safestart.missed_burn.prove import Proof, Verdict, prove
from safestart.missed_burn.question_document import question_document
from safestart.missed_burn.sets import pieces
from safestart.proofs.abort import check as checker
from safestart.proofs.abort import sets
from safestart.proofs.checker import check
from safestart.proofs.statement import digest_of
from safestart.proofs.strict import ProofRejected
from tests.unit.missed_burn.flights import EVERYTHING, ORBIT, STUDY, N, plan_of


def _sealed(document):
    document["digest"] = digest_of({k: v for k, v in document.items() if k != "digest"})
    return document


@pytest.fixture(scope="module")
def proof() -> Proof:
    return prove(Question(plan_of(40.0), 50.0, 2.0 * ORBIT, STUDY, EVERYTHING))


@pytest.fixture
def document(proof: Proof):
    return json.loads(json.dumps(document_of(proof)))


def test_a_document_is_checked_by_its_own_arithmetic(document, proof: Proof) -> None:
    verified = check(document)
    assert verified.verdict == "PROVED"
    assert verified.margin_m == proof.least
    assert verified.pieces == sum(len(finding.cells) for finding in proof.findings)
    assert any(
        f"misdirected by up to {math.radians(5.0)!r} rad (5 deg)" in line for line in verified.statement
    )


def test_no_number_of_the_statement_is_rounded(document) -> None:
    """A horizon of 17 199.96 s once read as 17 200 s, which nobody had proved."""
    document["question"]["horizon_s"] -= 0.04
    said = "\n".join(check(_sealed(document)).statement)
    for value in (
        document["question"]["horizon_s"],
        *document["question"]["failures"].values(),
        *(document["question"]["errors"][key] for key in ("thrust_share", "thrust_rad")),
    ):
        assert value is True or repr(value) in said


def test_errors_that_add_up_are_checked_too() -> None:
    errors = Errors((0.1,) * 3, (1e-4,) * 3, 1e-3, 1e-3, at_each_burn=False)
    made = prove(Question(plan_of(90.0, 3), 50.0, ORBIT, errors, EVERYTHING))
    assert made.verdict is Verdict.PROVED
    assert check(document_of(made)).verdict == "PROVED"


def _raise(document):
    document["least_distance_m"] *= 1.001


def _wider(document):
    document["question"]["errors"]["position_m"][0] *= 2.0


def _turned(document):
    document["question"]["errors"]["thrust_rad"] *= 1.2


def _longer(document):
    document["question"]["horizon_s"] *= 1.01


def _later(document):
    document["question"]["failures"]["late_s"] += 1.0


def _without(document):
    document["cases"] = [case for case in document["cases"] if case["kind"] != "stuck"]


def _hole(document):
    cells = document["cases"][3]["cells"]
    cells.remove(sorted(cells)[len(cells) // 2])


def _aside(document):
    for cell in document["cases"][4]["cells"]:
        cell[2:] = [0.0, 0.0, 1.0]


def _piece(document):
    late = [case for case in document["cases"] if case["kind"] == "late" and case["burn"] == 2]
    document["cases"].remove(late[-1])


@pytest.mark.parametrize("bent", [_raise, _wider, _turned, _longer, _later, _without, _hole, _aside, _piece])
def test_what_is_bent_is_refused(document, bent) -> None:
    bent(document)
    with pytest.raises(ProofRejected):
        check(_sealed(document))


def _one_hop(least: float):
    """A V-bar hop of one cell: at both ends 182 m away, 100 m in the middle."""
    impulse = [-0.25 * N * 82.0, 0.0, 0.0]
    cell = [0.0, ORBIT, 0.0, 1.0, 0.0]
    still = {"first_s": 0.0, "last_s": 0.0, "cells": [cell]}
    return _sealed(
        {
            "schema": "safestart-abort-proof/1",
            "verdict": "PROVED",
            "least_distance_m": least,
            "question": {
                "model": "linear",
                "mean_motion_rad_s": N,
                "start": {"position_m": [0.0, 182.0, 0.0], "velocity_m_s": [0.0, 0.0, 0.0]},
                "burns": [{"time_s": 0.0, "impulse_m_s": impulse}],
                "keep_out_m": least,
                "horizon_s": ORBIT,
                "errors": question_document(Question(plan_of(0.0), 1.0, 1.0))["errors"],
                "failures": question_document(Question(plan_of(0.0), 1.0, 1.0))["failures"],
            },
            "cases": [{"kind": "start", "burn": -1, **still}, {"kind": "made", "burn": 0, **still}],
        }
    )


def test_what_happens_between_the_samples_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ProofRejected, match="made, burn 0"):
        check(_one_hop(150.0))
    monkeypatch.setattr(checker, "_swing", lambda *_: 0)
    assert check(_one_hop(150.0)).verdict == "PROVED"  # false: the hop ends at 100 m


def test_the_direction_of_the_thrust_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    straight = Errors(STUDY.position, STUDY.velocity, STUDY.thrust_share, 0.0)
    made = prove(Question(plan_of(40.0), 50.0, 2.0 * ORBIT, straight))
    document = document_of(made)
    document["question"]["errors"]["thrust_rad"] = STUDY.thrust_angle
    with pytest.raises(ProofRejected, match="short by"):
        check(_sealed(document))
    shell = sets.shell
    monkeypatch.setattr(sets, "shell", lambda least, most, _: shell(least, most, sets.arb(0)))
    assert check(document).verdict == "PROVED"


def test_only_what_is_proved_has_a_document(proof: Proof) -> None:
    violated = Proof(proof.question, Verdict.UNKNOWN, 1.0, proof.findings, None)
    with pytest.raises(Conflict, match="UNKNOWN"):
        document_of(violated)


def test_verify_prints_the_statement(document, tmp_path) -> None:
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(document))
    result = CliRunner().invoke(build(), ["verify", str(path), "--json"])
    assert result.exit_code == 0, result.output
    said = json.loads(result.output)
    assert said["valid"]
    assert said["verdict"] == "PROVED"
    assert said["question"]["keep_out_m"] == 50.0


def test_pieces_of_time_end_where_their_length_does() -> None:
    """length * count / count may be another number: such documents were refused."""
    rng, missed = np.random.default_rng(4), 0
    for length, bend in zip(
        rng.uniform(1.0, 600.0, 2000).tolist(), rng.uniform(1e-4, 1.0, 2000), strict=True
    ):
        made = pieces(length, float(bend))
        assert (made[0][0], made[-1][1]) == (0.0, length)
        assert all(one[1] == two[0] for one, two in pairwise(made))
        missed += length * len(made) / len(made) != length
    assert missed > 10


def test_a_delay_whose_pieces_round_has_a_document_that_is_accepted() -> None:
    late = 47.24655414110222
    plan = plan_of(40.0, 1, 1200.0)
    asked = Question(plan, 10.0, 600.0, STUDY, Failures(late))
    count = len([case for case in cases_of(asked) if (case.kind, case.burn) == ("late", 0)])
    assert late * count / count != late
    assert check(document_of(prove(asked))).verdict == "PROVED"
