"""How long a run would take, told before it is submitted, and what that is known from."""

from __future__ import annotations

from safestart.processes.registry import process
from safestart.store.database import Database
from tests.contract.api.service_client import HEAVY, assert_problem, finish, submit, url_of
from tests.contract.store.store_backends import pass_time

OTHER = {"inputs": HEAVY["inputs"] | {"a_max_m_s2": 0.2}}


def asked(client, body, name="benchmark"):
    answer = client.post(f"/processes/{name}/estimate", json=body)
    assert answer.status_code == 200, answer.text
    return answer.json()


def ran(client, jobs, tmp_path, seconds):
    submit(client)
    claim = jobs.claim("tester", 3600.0)
    pass_time(Database(url_of(tmp_path)), seconds)
    jobs.succeed(claim, {"inputs": claim.inputs, "outputs": {}, "provenance": {}}, (), {})


def test_it_is_measured_where_something_ran(queue, tmp_path):
    client, jobs = queue
    nothing = {"basis": None, "seconds": None, "least_s": None, "most_s": None, "runs": 0}
    assert asked(client, HEAVY) == nothing
    for seconds in (20.0, 60.0, 30.0):
        ran(client, jobs, tmp_path, seconds)
    found = asked(client, HEAVY)
    assert (found["basis"], found["runs"]) == ("same inputs", 3)
    assert 30.0 <= found["seconds"] < 32.0
    assert 20.0 <= found["least_s"] < 22.0
    assert 60.0 <= found["most_s"] < 62.0
    assert asked(client, OTHER) == found | {"basis": "other inputs"}
    whole = {"inputs": process("benchmark").parse(HEAVY["inputs"]).model_dump(mode="json")}
    assert asked(client, whole)["basis"] == "same inputs", "a default that is spelled out changes nothing"
    assert jobs.list().total == 3, "nothing was queued"
    submit(client)
    finish(jobs)
    assert asked(client, HEAVY)["runs"] == 4


def test_a_process_that_knows_its_cost_is_believed_before_other_inputs(client):
    spec = process("safe-region")
    long = spec.example | {"horizon_s": 600.0}
    short, longer = (asked(client, {"inputs": inputs}, spec.id) for inputs in (spec.example, long))
    assert short["basis"] == longer["basis"] == "process"
    assert longer["seconds"] == spec.cost(spec.parse(long)) > short["seconds"]


def test_wrong_inputs_are_refused_as_by_the_execution(client):
    assert_problem(client.post("/processes/benchmark/estimate", json={"inputs": {}}), 422, "omega_t_deg_s")
    assert_problem(client.post("/processes/nothing/estimate", json={"inputs": {}}), 404)
    assert_problem(client.post("/processes/benchmark/estimate", content=b"{"), 415)


def test_it_takes_a_key_that_may_read(guarded):
    client, keys, _ = guarded
    assert_problem(client.post("/processes/benchmark/estimate", json=HEAVY), 401)
    answer = client.post("/processes/benchmark/estimate", json=HEAVY, headers={"X-API-Key": keys["read"]})
    assert answer.status_code == 200
