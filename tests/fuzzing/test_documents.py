"""A seeded part of the long run (``python -m tests.fuzzing``), and a check that it finds planted errors."""

from __future__ import annotations

import json
from dataclasses import replace
from random import Random
from typing import Any

import pytest

from safestart.proofs import refute, statement, weights
from safestart.proofs.checker import check
from safestart.proofs.hold.check import Hold
from safestart.proofs.single import Witness
from tests.fuzzing.abort.decided import truth_of_drifts
from tests.fuzzing.abort.made import MADE as OF_BURNS
from tests.fuzzing.abort.printed import printed as printed_drifts
from tests.fuzzing.documents import KINDS, original, run
from tests.fuzzing.files import FILES
from tests.fuzzing.plane.arrived import truth_after
from tests.fuzzing.plane.decided import truth
from tests.fuzzing.plane.disturbed import truth_against
from tests.fuzzing.plane.held import truth_held
from tests.fuzzing.plane.printed import Printed, printed
from tests.fuzzing.space.decided import truth_in_space
from tests.fuzzing.space.made import MADE as IN_SPACE
from tests.fuzzing.space.printed import printed as printed_in_space


def claim(kind: str) -> Printed:
    found = check(json.loads(original(kind)))
    return printed(found.verdict, found.margin_m, found.statement)


@pytest.mark.parametrize("kind", KINDS)
def test_no_mutant_is_accepted_with_a_false_statement(kind: str) -> None:
    number = 60 if kind.startswith(("family", "disturbed")) else 150
    if kind in IN_SPACE or kind in OF_BURNS:
        number = 3 if kind == "abort-earth" else 100
    found = run(kind, number, 1)
    assert not found.false, found.false[0]
    assert number < 40 or found.outcomes["accepted: the same statement"] > 0
    assert found.outcomes["rejected"] >= number // 2


@pytest.mark.parametrize(
    "kind", ["abort-linear", "abort-nonlinear", "disturbed-go", "space-go", "space-no-go"]
)
def test_what_is_remembered_is_what_a_check_finds(kind: str) -> None:
    anew, remembered = run(kind, 150, 2), run(kind, 150, 2, remembering=True)
    assert anew == remembered
    assert len(anew.outcomes) > 1


@pytest.mark.parametrize("kind", sorted(FILES))
def test_no_file_is_accepted_that_says_more_than_it_holds(kind: str) -> None:
    found = FILES[kind](250, 1)
    assert not found.false, found.false[0]
    assert found.outcomes["rejected"] > 50
    assert sum(count for name, count in found.outcomes.items() if name.startswith("accepted")) > 15


@pytest.mark.parametrize("kind", [kind for kind in IN_SPACE if kind != "space-members-no-go"])
def test_the_decision_in_space_is_one(kind: str) -> None:
    document = json.loads(original(kind))
    found = check(document)
    said = printed_in_space(found.verdict, found.margin_m, found.statement)
    assert truth_in_space(said, document, Random(3)) == "true"
    # Bounds for members are loose, a refuted end is solved to a tenth.
    more = {"space-members-go": 1.0, "space-synchronize-no-go": 1.0}.get(kind, 0.05)
    bent = replace(said, margin=said.margin + (more if said.verdict == "GO" else -more))
    assert truth_in_space(bent, document, Random(3)) == "false"


@pytest.mark.parametrize("kind", [kind for kind in OF_BURNS if kind != "abort-earth"])
def test_the_decision_of_drifts_is_one(kind: str) -> None:
    said = printed_drifts(check(json.loads(original(kind))).statement)
    assert truth_of_drifts(said, Random(3)) == "true"
    assert truth_of_drifts(replace(said, least=said.least + 5.0), Random(3)) == "false"
    assert truth_of_drifts(replace(said, least=said.keep_out - 1.0), Random(3)) == "false"


PLANAR = [kind for kind in KINDS if kind not in IN_SPACE and kind not in OF_BURNS]


@pytest.mark.parametrize("kind", [kind for kind in PLANAR if not kind.startswith("disturbed")])
def test_the_decision_is_one(kind: str) -> None:
    """The original's statement is true; with a little more it is false."""
    said, rng = claim(kind), Random(2)
    assert truth(said, rng) == "true"
    # A search that ends with the verdict may stop short of the best claim.
    more = {"synchronize-no-go": 1.0}.get(kind, 0.2 if said.who != "one" else 1e-3)
    assert (
        truth(replace(said, margin=said.margin + (more if said.verdict == "GO" else -more)), rng) == "false"
    )
    assert truth(replace(said, margin=-said.margin), rng) == "false"


@pytest.mark.parametrize(
    "change", [{"stop": 0.2}, {"stop": 2000.0}, {"after": 1.5}, {"thrusts": (0.005, 0.005)}, {"speed": 0.05}]
)
def test_the_decision_about_the_time_after_the_end_is_one(change: dict[str, Any]) -> None:
    said, document = claim("synchronize-go-moving"), json.loads(original("synchronize-go-moving"))
    assert truth_after(said, document) == "true"
    assert truth_after(replace(said, **change), document) == "false"


@pytest.mark.parametrize(
    "change",
    [
        *({"level": 4.0}, {"level": 1e-3}, {"margin": 0.7}, {"point": (0.1, 1.3)}, {"point": (1.0, 1.8)}),
        *({"gain": ((0.0,) * 4,) * 2}, {"gain": ((-0.1, 0.0, -0.5, 0.0), (0.0, -0.1, 0.0, -0.5))}),
        {"cost": tuple(tuple(0.5 * float(i == j) for j in range(4)) for i in range(4))},
    ],
)
def test_the_decision_about_a_feedback_is_one(change: dict[str, Any]) -> None:
    said, document = claim("synchronize-go-held"), json.loads(original("synchronize-go-held"))
    assert said.held is not None
    assert truth_held(said, said.held, document) == "true"
    assert truth_held(said, replace(said.held, **change), document) == "false"
    assert truth_held(replace(said, thrusts=(0.01, 0.01)), said.held, document) == "false"
    assert truth_held(replace(said, speed=0.1), said.held, document) == "false"


@pytest.mark.parametrize("blind", ["check", "_require"])
def test_a_checker_that_does_not_look_at_the_feedback_is_caught(
    monkeypatch: pytest.MonkeyPatch, blind: str
) -> None:
    monkeypatch.setattr(Hold, blind, lambda *_: None)
    assert run("synchronize-go-held", 400, 3).false


def test_a_checker_that_does_not_look_after_the_end_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Witness, "_after", lambda *_: None)
    assert run("synchronize-go-moving", 400, 3).false


@pytest.mark.parametrize("kind", ["disturbed-go", "disturbed-go-space"])
def test_the_decision_against_a_disturbance_is_one(kind: str) -> None:
    said, document, rng = claim(kind), json.loads(original(kind)), Random(2)
    assert truth_against(said, document, rng) == "true"
    # The tube is that of any number of steps, of which there are two here.
    share = 0.02
    assert truth_against(replace(said, margin=said.margin + 1e-3), document, rng) == "false"
    for tube in ("radius_m", "height_m", "thrust_m_s2"):
        if tube in document["tube"]:
            small = json.loads(original(kind))
            small["tube"][tube] *= share
            name = {"thrust_m_s2": "feedback"}.get(tube, tube)
            assert (
                truth_against(replace(said, **{name: share * getattr(said, name)}), small, rng) == "false"
            ), tube
    stronger = json.loads(original(kind))
    stronger["disturbance"]["acceleration_m_s2"] = 1.0
    assert truth_against(said, stronger, rng) == "false", "printed is another bound"
    assert truth_against(replace(said, push=1.0), stronger, rng) == "false"


def test_a_checker_that_does_not_mind_the_sign_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        statement, "_claim", lambda document, go: statement.number(document, "margin_m", -1e7)
    )
    monkeypatch.setattr(refute.Refutation, "check", lambda self: None)
    # Half of the seeds find it; which ones depends on the last bits of the multipliers.
    assert any(run("synchronize-no-go", 600, seed).false for seed in range(1, 41))


def test_a_checker_that_does_not_mind_the_ends_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """As it was: no parts refuted no end, and that was a proof."""
    whole = weights.parts_of

    def lenient(rows: list[Any], *rest: Any) -> Any:
        return whole(rows, *rest) if rows else []

    monkeypatch.setattr(statement, "parts_of", lenient)
    out = json.loads(original("synchronize-go"))
    del out["thrust_m_s2"], out["arrival"]
    out |= {"verdict": "NO_GO", "margin_m": -0.5, "parts": []}
    out["digest"] = statement.digest_of(out)
    found = check(out)
    assert truth(printed(found.verdict, found.margin_m, found.statement), Random(4)) == "false"


def test_a_checker_with_open_schemas_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = statement.fields

    def lenient(document: Any, name: str, needed: Any, optional: Any = ()) -> None:
        kept = {*needed, *optional}
        whole(
            {k: v for k, v in document.items() if k in kept} if isinstance(document, dict) else document,
            name,
            needed,
            optional,
        )

    monkeypatch.setattr(statement, "fields", lenient)
    assert run("stay-go", 300, 3).outcomes["accepted: unread"] > 0
