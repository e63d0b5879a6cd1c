"""A certified GO is never contradicted by the document beside it, which is about thrust held over steps."""

import json
from pathlib import Path
from typing import Any

import pytest

from safestart.processes.execute import execute
from safestart.proofs.single import check
from tests.contract.api.service_client import service

SHAPE = {
    "c_x": 2.3149501881112755,
    "c_z": 0.4246639543061794,
    "x0_m": 0.9677664118709123,
    "z0_m": 1.363513189375443,
    "r_h_m": 1.2693099580075593,
}
QUICK = {
    "omega_t_deg_s": 40.46397,
    "a_max_m_s2": 2.2855699664568316,
    "mean_motion_rad_s": 0.0013,
    "corridor": SHAPE,
}
"""A target so quick that it turns by 81 degrees in a step of 2 s."""
START = {"x_m": 1.39, "y_m": 2.77}
FLAT = {key: value for key, value in QUICK.items() if key != "corridor"} | SHAPE | START


def ask(**inputs: Any) -> dict[str, Any]:
    outputs: dict[str, Any] = execute("go-no-go", QUICK | {"states": [START]} | inputs).document["outputs"]
    return outputs


def test_a_start_that_is_go_stays_go_with_its_document() -> None:
    bare, proved = ask(), ask(proofs=True)
    held = ask(method="exact", proofs=True)
    assert (bare["verdict"], bare["decided_by"]) == (["GO"], ["certified"])
    # By name the exact method says what it was asked, in words that leave the other thrust open.
    assert held["verdict"] == ["NO_GO"]
    assert held["reason"][0].startswith("no thrust held over steps of 2 s stays for 60 s: each history is ")
    assert (proved["verdict"], proved["decided_by"]) == (["GO"], ["exact"])
    assert proved["reason"][0].endswith("thrust held over steps of 1 s")
    verified = check(json.loads(json.dumps(proved["proof"][0])))
    assert verified.verdict == "GO"
    assert verified.margin_m == pytest.approx(proved["margin_m"][0], abs=1e-5)


def test_where_no_shorter_step_is_left_the_theorem_stands_alone() -> None:
    bare, proved = ask(horizon_s=402), ask(horizon_s=402, proofs=True)
    assert (proved["verdict"], proved["decided_by"], proved["proof"]) == (["GO"], ["certified"], [None])
    assert (proved["margin_m"], proved["reason"]) == (bare["margin_m"], bare["reason"])


def test_other_starts_keep_their_documents() -> None:
    far = {"x_m": 0.0, "y_m": 200.0}
    proved = ask(states=[far, START], proofs=True)
    assert proved["verdict"] == ["NO_GO", "GO"]
    assert [check(json.loads(json.dumps(one))).verdict for one in proved["proof"]] == ["NO_GO", "GO"]


def test_the_linked_document_is_a_go_or_there_is_none(tmp_path: Path) -> None:
    with service(tmp_path) as client:
        answer = client.get("/go-no-go", params=FLAT).json()
        assert (answer["verdict"], answer["decided_by"]) == ("GO", "certified")
        assert check(client.get(answer["proof_url"]).json()).verdict == "GO"
        for_long = client.get("/go-no-go", params=FLAT | {"horizon_s": 402}).json()
        assert (for_long["verdict"], for_long["decided_by"]) == ("GO", "certified")
        none = client.get(for_long["proof_url"])
        assert none.status_code == 404
        assert "a known manoeuvre stays for ever" in none.json()["detail"]
        assert none.json()["received"] == "GO by certified"
