"""Jobs over the API: lists, progress, dismissal, results, events."""

from __future__ import annotations

import json
from typing import Any

import pytest

from safestart.records.artifact import Artifact
from safestart.store.database import Database
from safestart.store.models import ArtifactRow, ResultRow
from tests.contract.api.service_client import (
    PNG,
    assert_problem,
    digest,
    finish,
    submit,
    url_of,
)

OGC = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"


def test_job_list_pages_and_filters(queue):
    client, _ = queue
    made = [submit(client) for _ in range(5)]
    client.delete(f"/jobs/{made[0]}")
    seen: list[str] = []
    url: str | None = "/jobs?limit=2&processID=benchmark&processID=coverage"
    while url:
        page = client.get(url).json()
        seen += [job["jobID"] for job in page["jobs"]]
        url = next((link["href"] for link in page["links"] if link["rel"] == "next"), None)
    assert seen == made[::-1]
    back = next(link["href"] for link in page["links"] if link["rel"] == "prev")
    assert [job["jobID"] for job in client.get(back).json()["jobs"]] == made[2:0:-1]
    dismissed = client.get("/jobs", params={"status": "dismissed"}).json()["jobs"]
    assert [job["jobID"] for job in dismissed] == [made[0]]
    assert client.get("/jobs", params={"processID": "coverage"}).json()["jobs"] == []


@pytest.mark.parametrize(
    "query",
    ["limit=0", "limit=999999", "limit=x", "status=done", "processID=nope", "cursor=zzz", "colour=red"],
)
def test_bad_job_filters(client, query):
    assert_problem(client.get(f"/jobs?{query}"), 422, query.partition("=")[0])


def test_running_job_shows_progress(queue):
    client, jobs = queue
    job = submit(client)
    claim = jobs.claim("tester", 60.0)
    jobs.progress(claim, 37.4, "backward: step 3", 21.0)
    status = client.get(f"/jobs/{job}").json()
    assert (status["status"], status["progress"], status["eta_s"]) == ("running", 37, 21.0)
    assert status["message"] == "backward: step 3"
    assert status["position"] is None
    assert status["reason"] is None
    assert status["instant"]["r_sync_m"] == pytest.approx(72.9513, abs=1e-4)


def test_dismissal(queue):
    client, jobs = queue
    job = submit(client)
    assert client.delete(f"/jobs/{job}").json()["status"] == "dismissed"
    assert client.delete(f"/jobs/{job}").status_code == 200
    submit(client)
    finish(jobs)
    ended = client.get("/jobs", params={"status": "successful"}).json()["jobs"][0]["jobID"]
    assert_problem(client.delete(f"/jobs/{ended}"), 409, "jobID")


@pytest.mark.parametrize(
    "job", ["nope", "%00", "a" * 300, "..%2fjobs", "00000000-0000-0000-0000-000000000000"]
)
@pytest.mark.parametrize("rest", ["", "/results", "/events", "/artifacts/x"])
def test_no_such_job(client, job, rest):
    assert_problem(client.get(f"/jobs/{job}{rest}"), 404)


def test_ogc_problem_types(queue):
    client, _ = queue
    assert client.get("/jobs/nope").json()["type"] == OGC + "no-such-job"
    assert client.get("/processes/nope").json()["type"] == OGC + "no-such-process"
    execute = client.post("/processes/nope/execution", json={"inputs": {}})
    assert assert_problem(execute, 404)["type"] == OGC + "no-such-process"
    not_ready = client.get(f"/jobs/{submit(client)}/results")
    assert assert_problem(not_ready, 404)["type"] == OGC + "result-not-ready"


def test_failed_job(queue):
    client, jobs = queue
    job = submit(client)
    claim = jobs.claim("tester", 60.0)
    jobs.fail(claim, {"type": "about:blank", "title": "Broken", "status": 500, "detail": "the engine broke"})
    assert client.get(f"/jobs/{job}").json()["problem"]["detail"] == "the engine broke"
    assert "the engine broke" in assert_problem(client.get(f"/jobs/{job}/results"), 404)["detail"]


def test_results_and_artifacts_with_etags(queue):
    client, jobs = queue
    job = submit(client)
    finish(jobs)
    answer = client.get(f"/jobs/{job}/results")
    body = answer.json()
    assert body["outputs"]["rows"][0]["engine"] == "analytical"
    assert body["provenance"] == {"seed": 0}
    assert answer.headers["etag"] == f'"{body["sha256"]}"'
    for sent in (answer.headers["etag"], f'"other", W/{answer.headers["etag"]}', "*"):
        again = client.get(f"/jobs/{job}/results", headers={"If-None-Match": sent})
        assert (again.status_code, again.content) == (304, b"")
    assert client.get(f"/jobs/{job}/results", headers={"If-None-Match": '"other"'}).status_code == 200

    listed = {entry["name"]: entry for entry in body["artifacts"]}
    picture = client.get(listed["map.png"]["href"])
    assert (picture.headers["content-type"], picture.content) == ("image/png", PNG)
    assert picture.headers["etag"] == f'"{digest(PNG)}"' == f'"{listed["map.png"]["sha256"]}"'
    assert picture.headers["content-disposition"].startswith("inline")
    cached = client.get(listed["map.png"]["href"], headers={"If-None-Match": picture.headers["etag"]})
    assert cached.status_code == 304
    page = client.get(listed["page.html"]["href"])
    assert page.headers["content-disposition"].startswith("attachment"), (
        "nothing stored acts as a page of ours"
    )
    assert_problem(client.get(f"/jobs/{job}/artifacts/nope"), 404, "name")


def _events(text: str) -> list[dict[str, Any]]:
    blocks = [block for block in text.split("\n\n") if "data:" in block]
    return [dict(line.split(": ", 1) for line in block.splitlines()) for block in blocks]


def test_events_resume_and_end(queue):
    client, jobs = queue
    job = submit(client)
    finish(jobs)
    answer = client.get(f"/jobs/{job}/events")
    assert answer.headers["content-type"].startswith("text/event-stream")
    events = _events(answer.text)
    kinds = [event["event"] for event in events]
    assert kinds[0] == kinds[-1] == "status"
    assert {"progress", "log"} <= set(kinds)
    assert json.loads(events[-1]["data"])["status"] == "successful"
    ids = [int(event["id"]) for event in events]
    assert ids == sorted(set(ids))
    resumed = client.get(f"/jobs/{job}/events", headers={"Last-Event-ID": str(ids[1])})
    assert _events(resumed.text) == events[2:]
    assert client.get(f"/jobs/{job}/events", headers={"Last-Event-ID": str(ids[-1])}).status_code == 204
    for unknown in ("0", "999999999999"):
        whole = client.get(f"/jobs/{job}/events", headers={"Last-Event-ID": unknown})
        assert _events(whole.text) == events, "what is no event of the job says nothing of what was seen"
    for wrong in ("x", "-1", "1" * 30):
        assert_problem(
            client.get(f"/jobs/{job}/events", headers={"Last-Event-ID": wrong}), 422, "Last-Event-ID"
        )


def test_names_of_artifacts_in_links(queue, tmp_path):
    """Whatever a bundle called its files: the link leads to the file."""
    client, jobs = queue
    job = submit(client)
    claim = jobs.claim("tester", 60.0)
    names = ("a b?#%&.txt", "é;\n.txt")
    files = tuple(Artifact(name, "text/plain", name.encode()) for name in names)
    jobs.succeed(claim, {"inputs": claim.inputs, "outputs": {}, "provenance": {}}, files, {})
    for file in client.get(f"/jobs/{job}/results").json()["artifacts"]:
        assert file["href"].isascii()
        assert not set(file["href"]) & set(" ?#\n")
        assert client.get(file["href"]).content == file["name"].encode()


def test_a_result_that_was_altered_is_not_given_out(queue, tmp_path):
    client, jobs = queue
    job = submit(client)
    finish(jobs)
    assert client.get(f"/jobs/{job}/results").status_code == 200
    with Database(url_of(tmp_path)).session(write=True) as session:
        row = session.get_one(ResultRow, job)
        row.document = row.document | {"outputs": {"rows": []}}
        session.get_one(ArtifactRow, (job, "map.png")).data = b"forged"
    for path in ("results", "artifacts/map.png"):
        assert assert_problem(client.get(f"/jobs/{job}/{path}"), 500)["type"].endswith(":altered")
