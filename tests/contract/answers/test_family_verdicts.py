"""go-no-go with half-widths: process, HTTP and command line give the same verdict for all members."""

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

POINT = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}
WIDTHS = {
    "omega_t_half_width_deg_s": 0.03,
    "a_max_half_width_m_s2": 0.002,
    "mean_motion_half_width_rad_s": 1e-6,
    "position_half_width_m": 0.5,
    "velocity_half_width_m_s": 0.02,
}
STATES = [{"x_m": 12, "y_m": y} for y in (45, 60, 66, 75)]


def ask(**inputs: Any) -> dict[str, Any]:
    outputs: dict[str, Any] = execute("go-no-go", POINT | {"method": "exact"} | inputs).document["outputs"]
    return outputs


def test_verdicts_for_all_members() -> None:
    alone, every = ask(states=STATES), ask(states=STATES, proofs=True, **WIDTHS)
    assert alone["verdict"] == ["GO", "GO", "NO_GO", "NO_GO"]
    assert alone["examples"] is None
    assert every["verdict"] == ["GO", "UNDECIDED", "UNDECIDED", "NO_GO"]
    assert 0.0 < every["margin_m"][0] < alone["margin_m"][0]
    assert alone["margin_m"][3] < every["margin_m"][3] < 0.0
    assert every["margin_m"][1] is None
    for verdict, proof in zip(every["verdict"], every["proof"], strict=True):
        if verdict == "UNDECIDED":
            assert proof is None
        else:
            assert check(json.loads(json.dumps(proof))).verdict == verdict
    assert [len(examples) for examples in every["examples"]] == [0, 2, 2, 0]
    for examples in every["examples"][1:3]:
        assert {member["verdict"] for member in examples} == {"GO", "NO_GO"}
        for member in examples:
            assert abs(member["omega_t_deg_s"] - 3.0) <= 0.03 + 1e-12
            assert abs(member["a_max_m_s2"] - 0.1) <= 0.002 + 1e-12
            assert len(member["position_m"]) == 2
    assert "depends" in every["reason"][1]
    assert "one thrust history" in every["reason"][0]


def test_witness_per_corner_in_the_body_frame_and_in_space() -> None:
    corner = ask(states=STATES[:1], proofs=True, witness="per_corner", **WIDTHS)
    assert corner["verdict"] == ["GO"]
    assert len(corner["proof"][0]["histories"]) == 16
    assert "each corner" in corner["reason"][0]
    body = ask(states=[{"x_m": 0, "y_m": 15}], rest="body", proofs=True, position_half_width_m=0.3)
    assert check(body["proof"][0]).verdict == body["verdict"][0] == "GO"
    spatial = ask(
        states=[{"x_m": 0, "y_m": 30, "z_m": 4}], method="auto", proofs=True, omega_t_half_width_deg_s=0.1
    )
    assert check(spatial["proof"][0]).verdict == spatial["verdict"][0] == "GO"


@pytest.mark.parametrize(
    ("inputs", "field"),
    [
        ({"omega_t_half_width_deg_s": -0.1}, "omega_t_half_width_deg_s"),
        ({"omega_t_half_width_deg_s": 3.1}, "omega_t_half_width_deg_s"),
        ({"a_max_half_width_m_s2": 0.1}, "a_max_half_width_m_s2"),
        ({"a_max_half_width_m_s2": float("nan")}, "a_max_half_width_m_s2"),
        ({"mean_motion_half_width_rad_s": 1.2e-3}, "mean_motion_half_width_rad_s"),
        ({"mean_motion_half_width_rad_s": 5e-4}, "mean_motion_half_width_rad_s"),
        ({"position_half_width_m": float("inf")}, "position_half_width_m"),
        ({"velocity_half_width_m_s": "fast"}, "velocity_half_width_m_s"),
        ({"position_half_width_m": 0.5, "witness": "some"}, "witness"),
        ({"position_half_width_m": 0.5, "method": "closed_form"}, "method"),
        ({"position_half_width_m": 0.5, "question": "synchronize"}, "question"),
        ({"position_half_width_m": 0.5, "speed_limit_m_s": 1.0}, "question"),
        ({"position_half_width_m": 0.5, "states": STATES * 13}, "states"),
        ({"position_half_width_m": 0.5, "states": STATES * 3, "witness": "per_corner"}, "states"),
    ],
)
def test_bad_requests(inputs: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidInput) as error:
        ask(**({"states": STATES} | inputs))
    assert error.value.field == field


def test_over_http(tmp_path: Path) -> None:
    with service(tmp_path) as client:
        query = {**POINT, **STATES[0], **WIDTHS, "method": "exact"}
        one = client.get("/go-no-go", params=query).json()
        assert one["verdict"] == "GO"
        assert one["examples"] == []
        assert check(client.get(one["proof_url"]).json()).margin_m == pytest.approx(one["margin_m"], abs=1e-6)
        open_ = client.get("/go-no-go", params=query | STATES[1]).json()
        assert open_["verdict"] == "UNDECIDED"
        assert {member["verdict"] for member in open_["examples"]} == {"GO", "NO_GO"}
        body = POINT | WIDTHS | {"states": STATES, "method": "exact"}
        assert client.post("/go-no-go", json=body).json()["verdict"][3] == "NO_GO"
        refused = client.get("/go-no-go", params=query | {"method": "closed_form"})
        assert (refused.status_code, refused.json()["field"]) == (422, "method")
        refused = client.get("/go-no-go", params=query | {"omega_t_half_width_deg_s": 4})
        assert (refused.status_code, refused.json()["field"]) == (422, "omega_t_half_width_deg_s")


def test_command_line(tmp_path: Path) -> None:
    runner, path = CliRunner(), tmp_path / "proof.json"
    widths = [part for name, value in WIDTHS.items() for part in (f"--{name.replace('_', '-')}", str(value))]
    point = ["--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--method", "exact", *widths]
    done = runner.invoke(build(), ["go-no-go", *point, "--x-m", "12", "--y-m", "75", "--proof", str(path)])
    assert done.exit_code == 0, done.output
    assert "NO_GO" in done.stdout
    done = runner.invoke(build(), ["verify", str(path)])
    assert done.exit_code == 0
    assert "(2.97 to 3.03 deg/s)" in done.stdout
    done = runner.invoke(build(), ["go-no-go", *point, "--x-m", "12", "--y-m", "60"])
    assert done.exit_code == 0
    assert "UNDECIDED" in done.stdout
    assert "NO_GO for" in done.stdout
