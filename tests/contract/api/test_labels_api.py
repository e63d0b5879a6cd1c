"""Name, tags and note of a job over the API: at submission, afterwards, by whom; the list that is searched by them."""

from __future__ import annotations

import pytest

from safestart.processes.execute import execute
from safestart.processes.outcome import outcome_of
from tests.contract.api.service_client import HEAVY, POINT, assert_problem, finish, submit

START = {**POINT, "states": [{"x_m": 5, "y_m": 40}, {"x_m": 60, "y_m": 40}]}


def names(client, query: str) -> list[str]:
    answer = client.get(f"/jobs?{query}")
    assert answer.status_code == 200, answer.text
    return [job["name"] for job in answer.json()["jobs"]]


def test_a_job_is_labelled_at_submission_and_later(queue):
    client, jobs = queue
    sent = HEAVY | {"name": "first", "tags": ["envisat", "night"], "note": "two\nlines"}
    made = client.post("/processes/benchmark/execution", json=sent).json()
    assert (made["name"], made["tags"], made["note"]) == ("first", ["envisat", "night"], "two\nlines")
    assert made["outcome"] is None
    assert made["key_inputs"] == {
        "omega_t_deg_s": "3", "a_max_m_s2": "0.1", "grid.nx": "5", "grid.ny": "5", "grid.y_max_m": "150",
        "horizon_s": "40", "engines": "analytical",
    }  # fmt: skip
    place = f"/jobs/{made['jobID']}"
    tag = client.get(place).headers["ETag"]
    now = client.patch(place, json={"name": "second", "tags": []}).json()
    assert (now["name"], now["tags"], now["note"]) == ("second", [], "two\nlines")
    assert client.get(place, headers={"If-None-Match": tag}).json()["name"] == "second"
    assert client.patch(place, json={"note": None}).json()["note"] == "two\nlines"
    finish(jobs)
    assert client.patch(place, json={"note": "ended"}).json()["note"] == "ended"
    assert client.get("/jobs").json()["jobs"][0]["name"] == "second"


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({"name": "x" * 101}, "name"),
        ({"name": "a\nb"}, "name"),
        ({"tags": ["a,b"]}, "tags"),
        ({"tags": list("abcdefghijk")}, "tags"),
        ({"note": "\x1b"}, "note"),
        ({"status": "successful"}, "status"),
        ({"name": 3}, "name"),
    ],
)
def test_labels_out_of_bounds(queue, body, field):
    client, _ = queue
    job = submit(client)
    assert_problem(client.patch(f"/jobs/{job}", json=body), 422, field)
    if field != "status":
        assert_problem(client.post("/processes/benchmark/execution", json=HEAVY | body), 422, field)
    assert_problem(client.patch("/jobs/nothing", json={"name": "x"}), 404)
    assert_problem(client.patch(f"/jobs/{job}", content=b"name"), 415)


def test_only_ones_own_jobs_are_labelled(guarded):
    client, keys, _ = guarded
    by = {role: {"X-API-Key": key} for role, key in keys.items()}
    made = client.post("/processes/benchmark/execution", json=HEAVY, headers=by["admin"]).json()
    place = f"/jobs/{made['jobID']}"
    for role in ("read", "submit"):
        assert_problem(client.patch(place, json={"name": role}, headers=by[role]), 403)
    assert client.patch(place, json={"name": "mine"}, headers=by["admin"]).status_code == 200
    own = client.post("/processes/benchmark/execution", json=HEAVY, headers=by["submit"]).json()["jobID"]
    for role in ("submit", "admin"):
        now = client.patch(f"/jobs/{own}", json={"name": role}, headers=by[role]).json()
        assert now["name"] == role, "an administrator labels any"


def test_the_list_is_searched_sorted_and_counted(queue):
    client, _ = queue
    for name, tags in (("b", ["x"]), ("C", ["x", "y z"]), ("a", [])):
        client.post("/processes/benchmark/execution", json=HEAVY | {"name": name, "tags": tags})
    assert names(client, "tag=x") == ["C", "b"]
    assert names(client, "tag=x&tag=y%20z") == ["C"]
    assert names(client, "search=BENCH%20X") == ["C", "b"]
    assert names(client, "sort=name") == ["a", "b", "C"]
    assert names(client, "sort=-name&limit=2") == ["C", "b"]
    seen, url = [], "/jobs?sort=name&limit=1&tag=x"
    while url:
        page = client.get(url).json()
        assert page["total"] == 2
        seen += [job["name"] for job in page["jobs"]]
        url = next((link["href"] for link in page["links"] if link["rel"] == "next"), None)
    assert seen == ["b", "C"]
    back = next(link["href"] for link in page["links"] if link["rel"] == "prev")
    assert [job["name"] for job in client.get(back).json()["jobs"]] == ["b"]
    for wrong in ("sort=age", "offset=-1", "sort=name&cursor=YmVmb3JlOjE", f"search={'x' * 201}"):
        assert_problem(client.get(f"/jobs?{wrong}"), 422, wrong.rpartition("&")[2].partition("=")[0])
    assert names(client, "search=%00") == []


def test_the_outcome_is_the_worst_finding(queue):
    client, jobs = queue
    answer = client.post(
        "/processes/go-no-go/execution", json={"inputs": START}, headers={"Prefer": "respond-async"}
    )
    job = answer.json()["jobID"]
    claim = jobs.claim("tester", 60.0)
    document = execute("go-no-go", claim.inputs).document
    jobs.succeed(claim, document, (), {}, outcome_of("go-no-go", document["outputs"]))
    found = client.get("/jobs?verdict=NO_GO").json()["jobs"][0]
    assert found["jobID"] == job
    assert found["outcome"] == {"word": "NO_GO", "sense": "bad", "count": 1, "of": 2, "basis": None}
    assert client.get("/jobs?verdict=GO").json()["total"] == 0
