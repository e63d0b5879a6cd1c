"""Processes over the API: their descriptions, execution at once and queued."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from safestart.processes.registry import process
from tests.contract.api.service_client import (
    HEAVY,
    POINT,
    assert_problem,
    service,
    submit,
)


def test_process_list_and_description(client):
    listed = client.get("/processes").json()["processes"]
    assert [entry["id"] for entry in listed][:2] == ["go-no-go", "certificate"]
    for entry in listed:
        described = client.get(f"/processes/{entry['id']}").json()
        assert described["inputs"]
        assert described["outputs"]
        assert "$ref" not in json.dumps(described), "each schema stands alone"
        assert ("sync-execute" in described["jobControlOptions"]) == (process(entry["id"]).light)
    required = client.get("/processes/certificate").json()["inputs"]
    assert required["omega_t_deg_s"]["minOccurs"] == 1
    assert required["grid"]["minOccurs"] == 0


def test_the_benchmark_says_what_its_engines_look_like(client):
    described = client.get("/processes/benchmark").json()
    shown, asked = described["safestart:engines"], described["inputs"]["engines"]["schema"]
    names = [engine["name"] for engine in shown]
    assert names == asked["items"]["enum"]
    assert asked["default"] == [name for name in names if name != "tracking"], "runs only where it is named"
    assert {"name", "title", "colour", "summary"} == set(shown[0])
    assert {engine["name"]: engine["title"] for engine in shown}["forward"] == "forward (outer)"
    assert "safestart:engines" not in client.get("/processes/go-no-go").json()


def test_descriptions_accept_their_own_examples(client):
    import jsonschema

    for entry in client.get("/processes").json()["processes"]:
        described = client.get(f"/processes/{entry['id']}").json()
        for name, value in described["example"].items():
            jsonschema.validate(value, described["inputs"][name]["schema"])


def test_sync_execution_and_output_selection(client):
    inputs = {**POINT, "states": [{"x_m": 5, "y_m": 40}]}
    url = "/processes/go-no-go/execution"
    assert client.post(url, json={"inputs": inputs}).json()["verdict"] == ["GO"]
    chosen = client.post(url, json={"inputs": inputs, "outputs": {"verdict": {"transmissionMode": "value"}}})
    assert chosen.json() == {"verdict": ["GO"]}
    as_json = {"verdict": {"format": {"mediaType": "application/json"}}}
    assert client.post(url, json={"inputs": inputs, "outputs": as_json}).json() == {"verdict": ["GO"]}
    as_csv = {"verdict": {"format": {"mediaType": "text/csv"}}}
    assert_problem(client.post(url, json={"inputs": inputs, "outputs": as_csv}), 422, "mediaType")
    subscriber = {"successUri": "http://127.0.0.1:1/"}
    assert_problem(client.post(url, json={"inputs": inputs, "subscriber": subscriber}), 422, "subscriber")
    raw = client.post(url, json={"inputs": inputs, "outputs": {"verdict": {}}, "response": "raw"})
    assert raw.json() == ["GO"]
    assert_problem(client.post(url, json={"inputs": inputs, "outputs": {"nope": {}}}), 422, "outputs")
    assert_problem(client.post(url, json={"inputs": inputs, "response": "raw"}), 422, "response")


def test_heavy_execution_is_queued_with_its_certificate(queue):
    client, jobs = queue
    answer = client.post("/processes/benchmark/execution", json=HEAVY)
    assert answer.status_code == 201
    body = answer.json()
    assert answer.headers["location"] == f"http://127.0.0.1/jobs/{body['jobID']}"
    assert body["status"] == "accepted"
    assert body["position"] == 1
    assert "no worker" in body["reason"]
    assert np.array(body["certificate"]["mask"]).shape == (5, 5)
    assert body["certificate"]["r_sync_m"] == pytest.approx(72.9513, abs=1e-4)
    jobs.heartbeat("tester", 1, 0)
    second = client.get(f"/jobs/{submit(client)}").json()
    assert second["position"] == 2
    assert second["reason"].startswith("1 job ahead")


def test_light_execution_can_be_queued(queue):
    client, _ = queue
    answer = client.post(
        "/processes/certificate/execution",
        json={"inputs": POINT},
        headers={"Prefer": "respond-async; wait=10"},
    )
    assert answer.status_code == 201
    assert answer.headers["preference-applied"] == "respond-async"


@pytest.mark.parametrize(
    ("prefer", "status"),
    [
        (["respond-async"], 201),
        (["wait=5", "respond-async"], 201),
        (["handling=lenient, Respond-Async"], 201),
        (["wait=5; respond-async"], 200),
        (["wait=5"], 200),
    ],
)
def test_preferences_may_come_in_several_lines(queue, prefer, status):
    client, _ = queue
    lines = [("Prefer", line) for line in prefer]
    answer = client.post("/processes/certificate/execution", json={"inputs": POINT}, headers=lines)
    assert answer.status_code == status
    assert ("preference-applied" in answer.headers) == (status == 201)


def test_inputs_may_be_qualified_values(client):
    url = "/processes/certificate/execution"
    grid = {"nx": 5, "ny": 7}
    plain = client.post(url, json={"inputs": {**POINT, "grid": grid}})
    for qualified in ({"value": grid}, {"value": grid, "mediaType": "application/json"}):
        answer = client.post(url, json={"inputs": {**POINT, "grid": qualified}})
        assert answer.json() == plain.json()
    for wrong in ({"value": grid, "colour": "red"}, {"value": {"nx": "x"}}, {"href": "http://localhost/"}):
        assert_problem(client.post(url, json={"inputs": {**POINT, "grid": wrong}}), 422, "grid")


def test_process_list_pages(client):
    everything = client.get("/processes").json()
    assert [link["rel"] for link in everything["links"]] == ["self"]
    seen: list[str] = []
    url: str | None = "/processes?limit=5"
    while url:
        page = client.get(url).json()
        links = {link["rel"]: link["href"] for link in page["links"]}
        assert links["self"].endswith(url.removeprefix("http://127.0.0.1"))
        assert len(page["processes"]) <= 5
        seen += [entry["id"] for entry in page["processes"]]
        url = links.get("next")
    before = [entry["id"] for entry in client.get(links["prev"]).json()["processes"]]
    assert before == seen[-len(page["processes"]) - 5 : -len(page["processes"])]
    assert seen == [entry["id"] for entry in everything["processes"]]
    for wrong in ("limit=0", "limit=x", "offset=-1", "colour=red"):
        assert_problem(client.get(f"/processes?{wrong}"), 422, wrong.partition("=")[0])


def test_idempotency_key(queue):
    client, jobs = queue
    first = submit(client, **{"Idempotency-Key": "abc"})
    assert submit(client, **{"Idempotency-Key": "abc"}) == first
    marks = [
        client.post(
            "/processes/benchmark/execution", json=HEAVY, headers={"Idempotency-Key": key}
        ).headers.get("idempotency-replayed")
        for key in ("abc", "other", "other")
    ]
    assert marks == ["true", None, "true"]
    other = client.post(
        "/processes/coverage/execution", json={"inputs": {}}, headers={"Idempotency-Key": "abc"}
    )
    assert_problem(other, 422, "Idempotency-Key")
    assert jobs.counts()["accepted"] == 2


def test_one_key_at_once_from_many_threads_makes_one_job(queue):
    client, jobs = queue
    with ThreadPoolExecutor(20) as pool:
        made = list(pool.map(lambda _: submit(client, **{"Idempotency-Key": "abc"}), range(20)))
    assert len(set(made)) == 1
    assert jobs.counts()["accepted"] == 1


def test_queue_cap(tmp_path):
    with service(tmp_path, max_queued=1) as client:
        submit(client)
        answer = client.post("/processes/benchmark/execution", json=HEAVY)
        assert_problem(answer, 429)
        assert int(answer.headers["retry-after"]) > 0
