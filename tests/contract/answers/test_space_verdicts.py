"""The question in space through go-no-go: GET, POST, the proof's address and the command line say the same."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.proofs.checker import check
from tests.contract.api.service_client import service

if TYPE_CHECKING:
    from starlette.testclient import TestClient

SPIN = {"omega_t_deg_s": -2.67, "phase_deg": 20, "a_max_m_s2": 0.1, "frame": "body"}
START = {"position_m": [2, 25, 1], "velocity_m_s": [0, -0.2, 0]}
TUMBLE = {
    "kind": "torque_free",
    "inertia_kg_m2": [[17023, 0, 0], [0, 124826, 0], [0, 0, 129112]],
    "body_rate_deg_s": [0.3, 0.5, -2.0],
}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    with service(tmp_path_factory.mktemp("service")) as made:
        yield made


def flat(**inputs: Any) -> dict[str, str]:
    return {name: one if isinstance(one, str) else json.dumps(one) for name, one in inputs.items()}


def options(**inputs: Any) -> list[str]:
    return [f"--{name.replace('_', '-')}={one}" for name, one in flat(**inputs).items()]


def test_get_post_proof_and_command_line_agree(client: TestClient, tmp_path: Path) -> None:
    start = START | {"frame": "body"}
    asked = {"attitude": TUMBLE, "orbit": {"mean_motion_rad_s": 1.05e-3}, "a_max_m_s2": 0.1, "c_x": 1.2}
    body = {name: one for name, one in asked.items() if name != "c_x"}
    body |= {"starts": [start], "corridor": {"c_x": 1.2}}
    one = client.get("/go-no-go", params=flat(**start, **asked)).json()
    many = client.post("/go-no-go", json=body).json()
    listed = client.get("/go-no-go", params=flat(**start, **body)).json()
    assert "proof_url" in one, one
    proof = client.get(one["proof_url"])
    assert listed["field"] == "starts"
    for name in ("verdict", "margin_m", "reason", "position_m", "velocity_m_s"):
        assert many[name] == [one[name]]
    assert one["verdict"] == "GO"
    assert proof.headers["content-disposition"] == 'attachment; filename="proof.json"'
    assert check(proof.json()).verdict == "GO"
    runner, path, written = CliRunner(), tmp_path / "proof.json", tmp_path / "inputs.json"
    for given in (start | asked, body):
        written.write_text(json.dumps(given))
        done = runner.invoke(build(), ["go-no-go", "--input", str(written), "--proof", str(path), "--json"])
        assert done.exit_code == 0, done.output
        printed = json.loads(done.stdout)
        assert printed["margin_m"] == (one["margin_m"] if given is not body else many["margin_m"])
        assert json.loads(path.read_text()) == proof.json()
    done = runner.invoke(build(), ["verify", str(path)])
    assert "face 'right': [1.0, -1.2, 0.0]" in done.stdout


def test_demands_by_get_post_and_command_line(client: TestClient, tmp_path: Path) -> None:
    demands = {
        "keep_outs": [{"name": "panel", "radius_m": 5, "centre_m": [0, 10, 0]}],
        "field_of_view": {"axis": [0, -1, 0], "half_angle_deg": 70},
        "plume": {"half_angle_deg": 30, "range_m": 60},
    }
    one = client.get("/go-no-go", params=flat(**START, **SPIN, **demands)).json()
    body = {name: value for name, value in SPIN.items() if name != "frame"}
    many = client.post("/go-no-go", json=body | demands | {"starts": [START | {"frame": "body"}]}).json()
    assert one["verdict"] == many["verdict"][0] == "GO"
    assert many["restriction"] == [one["restriction"]]
    assert [said.split(":")[0] for said in one["restriction"]] == ["panel", "field_of_view", "plume"]
    assert "proof_url" in one, one
    proof = client.get(one["proof_url"]).json()
    assert check(proof).verdict == "GO"
    assert set(demands) <= set(proof["question"])
    done = CliRunner().invoke(build(), ["go-no-go", *options(**START, **SPIN, **demands), "--json"])
    assert json.loads(done.stdout)["restriction"] == one["restriction"]
    planar = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "x_m": 5, "y_m": 40}
    for more, field in (
        (planar | {"keep_outs": demands["keep_outs"]}, "position_m"),
        (START | SPIN | {"keep_outs": [{"name": "a"}]}, "keep_outs.0.half_widths_m"),
        (START | SPIN | {"plume": "[1]"}, "plume"),
    ):
        refused = client.get("/go-no-go", params=flat(**more))
        assert (refused.status_code, refused.json()["field"]) == (422, field)


def test_spins_of_either_sign_and_any_phase(client: TestClient) -> None:
    """Mirrored, and the orbit with it: none here."""
    here = client.get("/go-no-go", params=flat(**START, **SPIN, mean_motion_rad_s=0)).json()
    mirror = SPIN | {"omega_t_deg_s": 2.67, "phase_deg": -20}
    other = START | {"position_m": [-2, 25, 1]}
    there = client.get("/go-no-go", params=flat(**other, **mirror, mean_motion_rad_s=0)).json()
    ahead = client.get("/go-no-go", params=flat(**START, **(SPIN | {"phase_deg": 90}))).json()
    assert here["verdict"] == there["verdict"] == "GO"
    assert here["margin_m"] == pytest.approx(there["margin_m"], abs=2e-4)
    # Ahead by a quarter turn: body (2, 25) is LVLH (-25, 2).
    assert ahead["position_m"] == pytest.approx([-25, 2, 1], abs=1e-12)


def test_the_short_form_stays_and_the_two_do_not_mix(client: TestClient) -> None:
    short = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "x_m": 5, "y_m": 40}
    assert client.get("/go-no-go", params=short).json()["decided_by"] == "certified"
    for more, field in (
        ({"attitude": TUMBLE}, "position_m"),
        ({"phase_deg": 3}, "position_m"),
        ({"position_m": [1, 2, 3]}, "x_m"),
        ({"omega_t_deg_s": -3}, "omega_t_deg_s"),
    ):
        refused = client.get("/go-no-go", params=flat(**(short | more)))
        assert (refused.status_code, refused.json()["field"]) == (422, field)
    query = START | SPIN | {"corridor": {"faces": [{"name": "a", "normal": [0, -1, 0], "offset_m": -1}]}}
    assert client.get("/go-no-go", params=flat(**query)).json()["faces"] == ["a"]
    for more, field in (
        ({"corridor": {"c_x": -1}}, "corridor.c_x"),
        ({"corridor": None, "c_x": -1}, "c_x"),
        ({"velocity_m_s": "[1,2"}, "velocity_m_s"),
        ({"attitude": TUMBLE}, "attitude"),
        ({"omega_t_deg_s": -61}, "omega_t_deg_s"),
    ):
        asked = {name: one for name, one in (query | more).items() if one is not None}
        refused = client.get("/go-no-go", params=flat(**asked))
        assert (refused.status_code, refused.json()["field"]) == (422, field)


def test_the_command_line_for_people(tmp_path: Path) -> None:
    runner, written = CliRunner(), tmp_path / "inputs.json"
    done = runner.invoke(build(), ["go-no-go", *options(**START, **SPIN)])
    assert done.stdout.startswith("GO: a thrust history keeps ")
    near, far = (
        START | {"frame": "body"},
        {"position_m": [2, 250, 1], "frame": "body", "velocity_m_s": [9, 0, 0]},
    )
    written.write_text(json.dumps({"starts": [near, far], "omega_t_deg_s": -2.67}))
    done = runner.invoke(build(), ["go-no-go", f"--input={written}", "--a-max-m-s2=0.1"])
    assert [line.partition(":")[0] for line in done.stdout.splitlines()] == ["GO", "NO_GO"]
    written.write_text("[]")
    assert "--input" in str(runner.invoke(build(), ["go-no-go", f"--input={written}"]).exception)
