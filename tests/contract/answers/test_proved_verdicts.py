"""go-no-go with method exact and auto: process, HTTP and command line give the same proved verdicts."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.proofs.checker import check as check_any
from safestart.proofs.single import check
from tests.contract.api.service_client import service

POINT = {"omega_t_deg_s": 2, "a_max_m_s2": 0.05}
SLIVER = {"x_m": 9.364, "y_m": 81.044}
"""The paper's conditions certify it; no thrust history stays."""
STATES = [SLIVER, {"x_m": 0, "y_m": 40}, {"x_m": 200, "y_m": 20}]


def ask(**inputs: Any) -> dict[str, Any]:
    outputs: dict[str, Any] = execute("go-no-go", POINT | inputs).document["outputs"]
    return outputs


def test_exact_refuses_what_the_papers_conditions_let_pass() -> None:
    assert ask(states=STATES, method="paper")["verdict"] == ["GO", "GO", "NO_GO"]
    assert ask(states=STATES)["verdict"] == ["NO_GO", "GO", "NO_GO"]
    exact = ask(states=STATES, method="exact", proofs=True)
    assert exact["verdict"] == ["NO_GO", "GO", "NO_GO"]
    assert exact["violated_faces"][2] == ["right"]
    for verdict, margin, proof in zip(exact["verdict"], exact["margin_m"], exact["proof"], strict=True):
        verified = check(json.loads(json.dumps(proof)))
        assert verified.verdict == verdict
        assert verified.margin_m == pytest.approx(margin, abs=1e-5)


def test_auto_by_atlas_agrees_with_one_program_per_start() -> None:
    drawn = np.random.default_rng(2).uniform([-100, 0], [60, 120], (150, 2))
    states = [{"x_m": float(x), "y_m": float(y)} for x, y in drawn]
    one, many = ask(states=states, method="exact"), ask(states=states, method="auto")
    assert one["verdict"] == many["verdict"]
    assert {"GO", "NO_GO"} <= set(one["verdict"])


def test_space_and_body_rest() -> None:
    spatial = ask(states=[{"x_m": 0, "y_m": 40, "z_m": 5}], method="exact", proofs=True)
    assert check(spatial["proof"][0]).verdict == spatial["verdict"][0] == "GO"
    body = ask(states=[{"x_m": 0, "y_m": 20}], method="exact", rest="body", proofs=True)
    assert check(body["proof"][0]).verdict == body["verdict"][0]
    assert body["proof"][0]["start"]["velocity_m_s"] != [0.0, 0.0]


@pytest.mark.parametrize(
    ("inputs", "field"),
    [
        ({"method": "exact", "states": [SLIVER] * 1001}, "states"),
        ({"method": "auto", "states": [SLIVER | {"z_m": 0}] * 1001}, "states"),
        ({"method": "exact", "proofs": True, "states": [SLIVER] * 101}, "proofs"),
        ({"method": "oracle", "states": [SLIVER]}, "method"),
        ({"method": "exact", "horizon_s": 61, "states": [SLIVER]}, "horizon_s"),
    ],
)
def test_bad_requests(inputs: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidInput) as error:
        ask(**inputs)
    assert error.value.field == field


def test_over_http(tmp_path: Path) -> None:
    with service(tmp_path) as client:
        query = {**POINT, **SLIVER, "method": "exact", "proofs": True}
        one = client.get("/go-no-go", params=query).json()
        assert one["verdict"] == "NO_GO"
        assert one["method"] == "exact"
        assert one["margin_m"] == pytest.approx(-1.194, abs=1e-3)
        assert check(one["proof"]).verdict == "NO_GO"
        for method, verdict in (("paper", "GO"), ("closed_form", "GO"), ("auto", "NO_GO"), (None, "NO_GO")):
            more = {} if method is None else {"method": method}
            assert client.get("/go-no-go", params=POINT | SLIVER | more).json()["verdict"] == verdict
        many = client.post("/go-no-go", json=POINT | {"states": STATES, "method": "auto"}).json()
        assert many["verdict"] == ["NO_GO", "GO", "NO_GO"]
        refused = client.get("/go-no-go", params=query | {"method": "oracle"})
        assert refused.status_code == 422
        assert refused.json()["field"] == "method"


def test_starts_in_space_over_http(tmp_path: Path) -> None:
    """POST with ``starts`` is the question in space; the same as its process, refused under the fields' names."""
    body = {
        "starts": [{"position_m": [1, 30, 0.5], "velocity_m_s": [0, -0.1, 0], "frame": "body"}],
        "attitude": {
            "kind": "torque_free",
            "inertia_kg_m2": [[120, 2, -1], [2, 100, 3], [-1, 3, 60]],
            "body_rate_deg_s": [1, -1, 2],
        },
        "orbit": {"semi_major_axis_m": 24e6, "eccentricity": 0.7},
        "a_max_m_s2": 0.1,
        "proofs": True,
    }
    with service(tmp_path) as client:
        found = client.post("/go-no-go", json=body)
        assert found.status_code == 200
        assert found.json()["verdict"] == ["GO"]
        assert check_any(found.json()["proof"][0]).verdict == "GO"
        same = client.post("/processes/start-in-space/execution", json={"inputs": body}).json()
        assert same["verdict"] == ["GO"]
        for change, field in (
            ({"states": [{"x_m": 1, "y_m": 2}]}, "states"),
            ({"orbit": {"semi_major_axis_m": 7e6, "eccentricity": 0.6}}, "orbit.eccentricity"),
            ({"omega_t_deg_s": 1}, "attitude"),
        ):
            refused = client.post("/go-no-go", json=body | change)
            assert refused.status_code == 422
            assert refused.json()["field"] == field


def test_command_line_writes_a_proof_that_verifies(tmp_path: Path) -> None:
    runner, path = CliRunner(), tmp_path / "proof.json"
    where = ["--x-m", "9.364", "--y-m", "81.044", "--method", "exact", "--proof", str(path), "--json"]
    done = runner.invoke(build(), ["go-no-go", "--omega-t-deg-s", "2", "--a-max-m-s2", "0.05", *where])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["verdict"] == "NO_GO"
    assert runner.invoke(build(), ["verify", str(path)]).exit_code == 0
    path.write_text(path.read_text().replace("9.364", "9.363"))
    assert runner.invoke(build(), ["verify", str(path)]).exit_code == 1


def test_atlas_process_knows_the_sliver() -> None:
    result = execute("atlas", POINT | {"grid": {"nx": 201, "ny": 201, "y_max_m": 90}})
    outputs = result.document["outputs"]
    assert outputs["relative_gap"] <= 0.005
    assert outputs["certified_outside"] > 0
    assert {a.name for a in result.artifacts} == {"atlas.png", "atlas.npz", "proofs.npz"}
