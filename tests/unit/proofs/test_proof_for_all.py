"""Proofs for families: valid ones verify, every harmful change is refused with the inequality that fails."""

import copy
import json
from typing import Any

import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.errors import InvalidInput
from safestart.exact.answer import Verdict
from safestart.exact.question import Question
from safestart.families.answer import ForAll, Witness
from safestart.families.decide import decide_for_all
from safestart.families.members import Family
from safestart.families.prove import proof_for_all
from safestart.model.scenario import Scenario
from safestart.proofs.checker import check
from safestart.proofs.strict import ProofRejected
from tests.unit.families.test_for_all import family, start
from tests.unit.proofs.forgery import Change, assert_every_digit_counts, assert_refused, changed, sealed


def document(verdict: str, dimensions: int = 2, witness: Witness = "common") -> dict[str, Any]:
    made = family(dimensions)
    if witness == "per_corner":
        made = Family(made.question, made.tumble_rate, made.max_acceleration, start=(0.0, 0.5, 0.02, 0.0))
    state = start(12.0, 55.0, dimensions) if verdict == "GO" else start(12.0, 75.0, dimensions)
    answer = decide_for_all(made, state, witness=witness)
    assert answer.verdict.value == verdict
    out: dict[str, Any] = json.loads(json.dumps(proof_for_all(made, state, answer)))
    assert abs(out["margin_m"] - answer.margin_m) < 1e-6
    return out


MADE = {
    "GO": document("GO"),
    "NO_GO": document("NO_GO"),
    "per_corner": document("GO", witness="per_corner"),
}


@pytest.mark.parametrize("made", [*MADE.values(), document("NO_GO", 3)])
def test_valid_proofs(made: dict[str, Any]) -> None:
    verified = check(made)
    assert (verified.verdict, verified.margin_m) == (made["verdict"], made["margin_m"])


def test_in_space_and_in_several_pieces() -> None:
    assert check(document("GO", 3)).pieces > 100
    wide = Family(Question(Scenario.of(4.0, 0.05)), tumble_rate=0.03)
    answer = decide_for_all(wide, start(3.0, 75.0))
    assert answer.verdict is Verdict.NO_GO
    assert len(answer.pieces) > 1
    made = proof_for_all(wide, start(3.0, 75.0), answer)
    check(made)
    gap = copy.deepcopy(made)
    del gap["pieces"][1]
    with pytest.raises(ProofRejected, match="pieces: required"):
        check(sealed(gap))


def _rates(made: dict[str, Any]) -> None:
    """The tumble may be 5 % faster, or slower, too: at the nodes and in the pieces as well."""
    ends = made["question"]["tumble_rate_rad_s"]
    if made["verdict"] == "GO":
        ends[1] = made["tumble_rates_rad_s"][-1] = 1.05 * ends[1]
    else:
        ends[0] = made["pieces"][0]["tumble_rate_rad_s"][0] = 0.7 * ends[0]


def _node(made: dict[str, Any]) -> None:
    del made["tumble_rates_rad_s"][-1]


def _few_nodes(made: dict[str, Any]) -> None:
    """Far apart in angle: what lies between costs more than the margin leaves."""
    made["question"]["tumble_rate_rad_s"][0] = made["tumble_rates_rad_s"][0] = 0.03


def _motions(made: dict[str, Any]) -> None:
    made["question"]["mean_motion_rad_s"][1] = made["mean_motions_rad_s"][-1] = 2e-3


def _thrusts(made: dict[str, Any]) -> None:
    k, factor = (0, 0.9) if made["verdict"] == "GO" else (1, 1.2)
    made["question"]["max_acceleration_m_s2"][k] *= factor


def _swapped(made: dict[str, Any]) -> None:
    made["question"]["max_acceleration_m_s2"].reverse()


def _box(made: dict[str, Any]) -> None:
    made["start"]["position_half_width_m"][0] += 4.0


def _fast_box(made: dict[str, Any]) -> None:
    made["start"]["velocity_half_width_m_s"][0 if made["verdict"] == "GO" else 1] += 0.3


def _start(made: dict[str, Any]) -> None:
    made["start"]["position_m"][1] -= 0.0 if made["verdict"] == "GO" else 20.0
    made["start"]["position_m"][0] += 3.0


def _claim(made: dict[str, Any]) -> None:
    made["margin_m"] += 0.004 if made["verdict"] == "GO" else -0.3


def _thrust(made: dict[str, Any]) -> None:
    made["histories"][0]["thrust_m_s2"][0] = [0.0979, 0.0]


def _corner(made: dict[str, Any]) -> None:
    made["histories"][0]["corner"][2] *= -1


def _lost_corner(made: dict[str, Any]) -> None:
    del made["histories"][2]


def _as_common(made: dict[str, Any]) -> None:
    """One corner's history passed off as good for all."""
    made["witness"] = "common"
    made["histories"] = [made["histories"][0] | {"corner": [0, 0, 0, 0]}]


def _multiplier(made: dict[str, Any]) -> None:
    min(made["pieces"][0]["multipliers"], key=lambda r: r["value"])["value"] += 3.0


def _piece(made: dict[str, Any]) -> None:
    made["pieces"][0]["tumble_rate_rad_s"][1] *= 0.999


def _other_verdict(made: dict[str, Any]) -> None:
    made["verdict"] = "NO_GO" if made["verdict"] == "GO" else "GO"


@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("GO", _rates, "distance to"),
        ("GO", _node, "tumble_rates_rad_s"),
        ("GO", _few_nodes, "distance to"),
        ("GO", _motions, "distance to"),
        ("GO", _thrusts, "a_max"),
        ("GO", _swapped, "ascending"),
        ("GO", _box, "distance to"),
        ("GO", _fast_box, "distance to"),
        ("GO", _start, "distance to"),
        ("GO", _claim, "distance to"),
        ("GO", _thrust, "distance to"),
        ("GO", _other_verdict, "pieces"),
        ("NO_GO", _rates, "bound is"),
        ("NO_GO", _thrusts, "bound is"),
        ("NO_GO", _swapped, "ascending"),
        ("NO_GO", _box, "bound is"),
        ("NO_GO", _fast_box, "bound is"),
        ("NO_GO", _start, "bound is"),
        ("NO_GO", _claim, "bound is"),
        ("NO_GO", _multiplier, "bound is"),
        ("NO_GO", _piece, "pieces: required"),
        ("NO_GO", _other_verdict, "tumble_rates_rad_s"),
        ("per_corner", _corner, "histories"),
        ("per_corner", _lost_corner, "histories"),
        ("per_corner", _as_common, "distance to"),
        ("per_corner", _thrusts, "a_max"),
    ],
)
def test_harmful_changes(name: str, change: Change, said: str) -> None:
    assert_refused(check, MADE[name], change, said)


@pytest.mark.parametrize("name", sorted(MADE))
def test_a_digit_anywhere(name: str) -> None:
    assert_every_digit_counts(check, MADE[name], 40)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("verdict", "UNDECIDED"),
        ("witness", "some"),
        ("margin_m", None),
        ("histories", []),
        ("histories", [{}]),
        ("histories", [{"corner": [0, 0, 0, 0]}]),
        ("histories", [3]),
        ("tumble_rates_rad_s", 0.05),
        ("tumble_rates_rad_s", []),
        ("mean_motions_rad_s", ["0"]),
        ("question", None),
        ("question.tumble_rate_rad_s", 0.05),
        ("question.tumble_rate_rad_s", [0.05]),
        ("question.mean_motion_rad_s", [10**400, 10**401]),
        ("question.dimensions", 3),
        ("start.position_half_width_m", [0.5]),
        ("start.position_half_width_m", [0.5, -0.1]),
        ("start.velocity_half_width_m_s", None),
    ],
)
def test_malformed(key: str, value: Any) -> None:
    with pytest.raises(ProofRejected):
        check(changed(MADE["GO"], key, value))


@pytest.mark.parametrize("pieces", [[], [3], [{"tumble_rate_rad_s": [0.0, 1.0]}], None])
def test_malformed_pieces(pieces: Any) -> None:
    with pytest.raises(ProofRejected):
        check(changed(MADE["NO_GO"], "pieces", pieces))


def test_undecided_proves_nothing() -> None:
    answer = ForAll(Verdict.UNDECIDED, 0.0, 0.0, "common")
    with pytest.raises(InvalidInput):
        proof_for_all(family(), start(12.0, 45.0), answer)


def test_verify_command(tmp_path: Any) -> None:
    run, app, path = CliRunner(), build(), tmp_path / "proof.json"
    for made in MADE.values():
        path.write_text(json.dumps(made))
        done = run.invoke(app, ["verify", str(path)])
        assert done.exit_code == 0, done.output
        assert made["verdict"] in done.stdout
        assert "+-" in done.stdout
        assert json.loads(run.invoke(app, ["verify", str(path), "--json"]).stdout)["valid"]
    done = run.invoke(app, ["verify", "-", "--json"], input=json.dumps(MADE["GO"] | {"margin_m": 80.0}))
    assert done.exit_code == 1
