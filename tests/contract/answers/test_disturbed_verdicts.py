"""A disturbance asked of go-no-go: process, HTTP and command line give one answer, with proofs that check."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.proofs.checker import check
from tests.contract.api.service_client import service

POINT = {"omega_t_deg_s": 2, "a_max_m_s2": 0.05}
NEAR, SLIVER, EDGE = {"x_m": 5, "y_m": 40}, {"x_m": 9.364, "y_m": 81.044}, {"x_m": 0, "y_m": 86}
ASK = {"method": "exact", "disturbance_m_s2": 0.004}


def ask(**inputs: Any) -> dict[str, Any]:
    outputs: dict[str, Any] = execute("go-no-go", POINT | ASK | inputs).document["outputs"]
    return outputs


def test_three_verdicts_and_what_their_proofs_are_about() -> None:
    found = ask(states=[NEAR, SLIVER, EDGE], proofs=True)
    assert found["verdict"] == ["GO", "NO_GO", "UNDECIDED"]
    go, no_go, none = found["proof"]
    assert check(json.loads(json.dumps(go))).verdict == "GO"
    # The question that was asked, the bounds, and the tube: the plan has less thrust and a narrower corridor.
    assert go["question"] == no_go["question"]
    assert go["disturbance"] == {"acceleration_m_s2": 0.004, "position_m": 0.0, "velocity_m_s": 0.0}
    assert go["tube"]["thrust_m_s2"] == pytest.approx(1.583 * 0.004, abs=1e-5)
    assert go["tube"]["radius_m"] == pytest.approx(36.2 * 0.004, abs=1e-3)
    said = " ".join(check(go).statement)
    assert "an acceleration of at most 0.004 m/s^2" in said
    assert "y >= 0.644902, |x| <= 2.23877 + 1.5 (y - 0.5), with 0.0436688 m/s^2" in said
    assert check(json.loads(json.dumps(no_go))).verdict == "NO_GO"
    assert no_go["question"]["max_acceleration_m_s2"] == 0.05
    assert none is None
    assert found["reason"][0].startswith("against every disturbance up to 0.004 m/s^2")
    assert found["reason"][1].startswith("even undisturbed no thrust held over steps of 2 s stays")
    assert found["reason"][2].startswith("undecided: no plan fits the tube")
    calm = ask(states=[NEAR, EDGE], disturbance_m_s2=0)
    assert calm["verdict"] == ["GO", "GO"]
    assert calm["margin_m"][0] > found["margin_m"][0] > 0.0


def test_start_errors_space_and_auto() -> None:
    spread = ask(states=[NEAR], start_error_m=2, start_error_m_s=0.02)
    assert spread["verdict"] == ["GO"]
    assert spread["reason"][0].startswith(
        "against every disturbance up to 0.004 m/s^2 and start error up to 2 m and 0.02 m/s"
    )
    alone = ask(states=[NEAR], disturbance_m_s2=0, start_error_m=2, method="auto")
    assert alone["margin_m"][0] > spread["margin_m"][0]
    space = ask(states=[{"x_m": 3, "y_m": 40, "z_m": 2}], start_error_m=0.5, proofs=True)
    assert space["verdict"] == ["GO"]
    assert check(json.loads(json.dumps(space["proof"][0]))).verdict == "GO"
    assert space["proof"][0]["tube"]["height_m"] > 0.5
    nothing = ask(states=[NEAR], disturbance_m_s2=0.04)
    assert nothing["verdict"] == ["UNDECIDED"]
    assert "the feedback may ask for" in nothing["reason"][0]


BAD = [
    ({"disturbance_m_s2": 0.001, "method": "closed_form"}, "method"),
    ({"start_error_m": 1, "method": "closed_form", "disturbance_m_s2": 0}, "method"),
    ({"question": "synchronize"}, "disturbance_m_s2"),
    ({"speed_limit_m_s": 1}, "disturbance_m_s2"),
    ({"disturbance_m_s2": -1}, "disturbance_m_s2"),
    ({"disturbance_m_s2": "strong"}, "disturbance_m_s2"),
    ({"start_error_m": 1e4}, "start_error_m"),
    ({"start_error_m_s": 11}, "start_error_m_s"),
    ({"states": [NEAR] * 1001}, "states"),
    ({"position_half_width_m": 1}, "disturbance_m_s2"),
]


@pytest.mark.parametrize(("change", "field"), BAD)
def test_bad_inputs_name_the_field(change: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidInput) as error:
        ask(**({"states": [NEAR]} | change))
    assert error.value.field == field


def test_http_and_command_line(tmp_path: Path) -> None:
    inputs = POINT | ASK | NEAR
    with service(tmp_path) as client:
        found = client.get("/go-no-go", params=inputs).json()
        proof = client.get(found["proof_url"]).json()
        by_default = client.get("/go-no-go", params=POINT | NEAR | {"disturbance_m_s2": 0.004}).json()
        refused = client.get("/go-no-go", params=inputs | {"method": "certified"})
    assert found["verdict"] == "GO"
    assert check(proof).verdict == "GO"
    assert by_default == found | {"method": "auto", "proof_url": by_default["proof_url"]}
    assert refused.status_code == 422
    assert refused.json()["field"] == "method"
    written = tmp_path / "proof.json"
    arguments = [f"--{name.replace('_', '-')}={value}" for name, value in inputs.items()]
    done = CliRunner().invoke(build(), ["go-no-go", *arguments, f"--proof={written}", "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["margin_m"] == found["margin_m"]
    assert json.loads(written.read_text()) == proof
