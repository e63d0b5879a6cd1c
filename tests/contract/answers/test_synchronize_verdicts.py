"""Synchronize, speed limit and keep-out through process, HTTP and command line: one answer, one proof."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.errors import InvalidInput
from safestart.processes.execute import execute
from safestart.proofs.single import check
from tests.contract.api.service_client import service

POINT = {"omega_t_deg_s": 2, "a_max_m_s2": 0.05}
NEAR, FAR = {"x_m": 5, "y_m": 40}, {"x_m": 20, "y_m": 78}
SYNC = {"method": "exact", "question": "synchronize", "proofs": True}


def ask(**inputs: Any) -> dict[str, Any]:
    outputs: dict[str, Any] = execute("go-no-go", POINT | inputs).document["outputs"]
    return outputs


def test_both_verdicts_with_their_proofs() -> None:
    found = ask(states=[NEAR, FAR], **SYNC)
    assert found["question"] == "synchronize"
    assert found["verdict"] == ["GO", "NO_GO"]
    assert found["end_s"] == [200.0, None]
    for verdict, margin, proof in zip(found["verdict"], found["margin_m"], found["proof"], strict=True):
        verified = check(json.loads(json.dumps(proof)))
        assert verified.verdict == verdict
        assert verified.margin_m == pytest.approx(margin, abs=1e-5)
    assert "at rest in the hold ball after 200 s" in found["reason"][0]
    assert "within 200 s" in found["reason"][1]
    # Not by 20 s: 40 m take more than that at 0.05 m/s^2. Auto asks no atlas for this question.
    soon = ask(states=[NEAR], method="auto", question="synchronize", within_s=20)
    assert (soon["verdict"], soon["end_s"], soon["proof"]) == (["NO_GO"], [None], None)


def test_the_hold_after_it() -> None:
    """A third start stands by a face so near that no set of the LQR holds its end."""
    hold = SYNC | {"after_arrival": "hold"}
    found = ask(states=[NEAR, FAR], **hold)
    assert found["verdict"] == ["GO", "NO_GO"]
    near, far = found["hold_after"]
    assert far is None
    assert near["code"] == "proved"
    assert "keeps it for ever, thrust held over steps of 2 s" in found["reason"][0]
    proof = found["proof"][0]
    assert near["level"] == proof["hold_after"]["level"]
    assert any("under a feedback" in line for line in check(json.loads(json.dumps(proof))).statement)
    # A ball of a millimetre on the hold plane leaves no room for errors of rounding.
    edge = ask(states=[NEAR], **hold, ball_radius_m=0.001, rest_speed_m_s=0.05)
    assert edge["verdict"] == ["UNDECIDED"]
    assert edge["proof"] == [None]
    assert edge["hold_after"] == [{"code": "not_proved"} | dict.fromkeys(set(near) - {"code"})]
    assert "for ever" not in edge["reason"][0]
    for other in ("stay", "any"):
        plain = ask(states=[NEAR], **SYNC, after_arrival=other)
        assert "hold_after" not in plain
        assert "hold_after" not in plain["proof"][0]
    assert "hold_after" not in ask(states=[NEAR], method="exact", after_arrival="hold"), "nothing arrives"
    with pytest.raises(InvalidInput, match="planar") as error:
        ask(states=[NEAR | {"z_m": 1}], **hold)
    assert error.value.field == "after_arrival"


def test_limits_in_space_and_at_rest_in_the_body_frame() -> None:
    spatial = ask(
        states=[{"x_m": 3, "y_m": 20, "z_m": 2}], **SYNC, hold_y_m=2, hold_z_m=0.5, speed_limit_m_s=1
    )
    assert spatial["verdict"] == ["GO"]
    question = spatial["proof"][0]["question"]
    assert question["goal"] == {"hold_m": [0.0, 2.0, 0.5], "radius_m": 0.5, "rest_m_s": 0.05}
    assert question["speed_limit"] == {"most_m_s": 1.0, "scale_s": 10.0}
    # At rest in the body frame at 40 m a chaser moves at 1.4 m/s in LVLH.
    body = ask(states=[{"x_m": 0, "y_m": 40}], rest="body", method="exact", speed_limit_m_s=1)
    assert body["verdict"] == ["NO_GO"]
    assert body["end_s"] is None
    assert "1 m/s" in body["reason"][0]
    implied = ask(states=[NEAR], method="exact", keep_out_m=0.5)
    assert implied["reason"][0].endswith("the hold plane implies the keep-out radius")


BAD = [
    ({"keep_out_m": 0.6, "method": "exact"}, "keep_out_m", "not convex"),
    ({"question": "synchronize", "method": "certified"}, "method", "exact or auto"),
    ({"speed_limit_m_s": 1, "method": "certified"}, "method", "exact or auto"),
    ({"keep_out_m": 0.1, "method": "certified"}, "method", "exact or auto"),
    ({"question": "leave", "method": "exact"}, "question", ""),
    ({"question": "synchronize", "method": "exact", "within_s": 601}, "within_s", ""),
    ({"question": "synchronize", "method": "exact", "within_s": 3}, "within_s", ""),
    (
        {"question": "synchronize", "method": "exact", "hold_y_m": 0.25},
        "hold_x_m, hold_y_m, hold_z_m",
        "corridor",
    ),
    (
        {"question": "synchronize", "method": "exact", "hold_x_m": 90},
        "hold_x_m, hold_y_m, hold_z_m",
        "corridor",
    ),
    ({"question": "synchronize", "method": "exact", "ball_radius_m": 0}, "ball_radius_m", ""),
    ({"question": "synchronize", "method": "exact", "rest_speed_m_s": -1}, "rest_speed_m_s", ""),
    ({"method": "exact", "speed_limit_m_s": 0}, "speed_limit_m_s", ""),
    ({"method": "exact", "speed_limit_m_s": "nan"}, "speed_limit_m_s", ""),
]


@pytest.mark.parametrize(("inputs", "field", "said"), BAD)
def test_bad_inputs(inputs: dict[str, Any], field: str, said: str) -> None:
    with pytest.raises(InvalidInput) as error:
        ask(states=[NEAR], **inputs)
    assert error.value.field == field
    assert said in error.value.detail


def test_too_many_starts() -> None:
    for inputs in ({"question": "synchronize"}, {"speed_limit_m_s": 1}):
        with pytest.raises(InvalidInput, match="at most 100"):
            ask(states=[NEAR] * 101, method="auto", **inputs)


def test_over_http(tmp_path: Path) -> None:
    with service(tmp_path) as client:
        one = client.get("/go-no-go", params=POINT | NEAR | SYNC).json()
        assert (one["verdict"], one["question"], one["end_s"]) == ("GO", "synchronize", 200.0)
        assert check(one["proof"]).verdict == "GO"
        alone = client.get(one["proof_url"]).json()
        assert alone == one["proof"]
        assert client.get("/go-no-go", params=POINT | NEAR).json()["question"] == "stay"
        many = client.post("/go-no-go", json=POINT | {"states": [NEAR, FAR]} | SYNC).json()
        assert many["verdict"] == ["GO", "NO_GO"]
        held = client.get("/go-no-go", params=POINT | NEAR | SYNC | {"after_arrival": "hold"}).json()
        assert held["hold_after"]["code"] == "proved"
        assert client.get(held["proof_url"]).json() == held["proof"]
        assert "hold_after" not in one
        for inputs, field, said in BAD:
            for refused in (
                client.get("/go-no-go", params=POINT | NEAR | inputs),
                client.post("/go-no-go", json=POINT | {"states": [NEAR]} | inputs),
            ):
                assert refused.status_code == 422
                problem = refused.json()
                assert problem["field"] == field
                assert said in problem["detail"]


def test_command_line(tmp_path: Path) -> None:
    runner, path = CliRunner(), tmp_path / "proof.json"
    point = ["go-no-go", "--omega-t-deg-s", "2", "--a-max-m-s2", "0.05", "--x-m", "5", "--y-m", "40"]
    asked = ["--method", "exact", "--question", "synchronize", "--speed-limit-m-s", "3", "--hold-y-m", "2"]
    done = runner.invoke(build(), [*point, *asked, "--keep-out-m", "0.5", "--proof", str(path), "--json"])
    assert done.exit_code == 0, done.output
    answer = json.loads(done.stdout)
    assert (answer["verdict"], answer["end_s"]) == ("GO", 200.0)
    verified = runner.invoke(build(), ["verify", str(path)])
    assert verified.exit_code == 0
    for said in ("within 0.5 m of", "speed: at most 3.0 m/s", "keep-out radius: 0.5 m"):
        assert said in verified.stdout
    refused = runner.invoke(build(), [*point, "--method", "exact", "--keep-out-m", "1"])
    assert refused.exit_code != 0
    assert isinstance(refused.exception, InvalidInput)
