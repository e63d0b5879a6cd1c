"""The calls of the API over an in-process client: answers, jobs, results, events."""

from __future__ import annotations

import io
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safestart.artifact import Artifact
from safestart.certificates.closed_form import certify, range_limit
from safestart.processes.go_no_go.run import run
from safestart.processes.go_no_go.spec import GoNoGoInputs
from safestart.progress import Context
from safestart.scenario import Chaser, CorridorShape, Rest, Scenario, Target
from tests.contract.service_client import (
    HEAVY,
    PNG,
    POINT,
    assert_problem,
    digest,
    finish,
    jobs_of,
    service,
    submit,
)

OGC = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    """For calls that leave no jobs."""
    with service(tmp_path_factory.mktemp("shared")) as found:
        yield found


@pytest.fixture
def queue(tmp_path: Path):
    """A client and its queue, empty at first."""
    with service(tmp_path) as found:
        yield found, jobs_of(tmp_path)


# Instant answers


def test_go_no_go_single(client):
    answer = client.get("/go-no-go", params={**POINT, "x_m": 5, "y_m": 40})
    assert answer.status_code == 200
    body = answer.json()
    assert body["verdict"] == "GO"
    assert body["r_sync_m"] == pytest.approx(72.9513, abs=1e-4)
    assert set(body["face_margins_m"]) == {"hold_plane", "right", "left"}
    assert body["margin_m"] == min(*body["face_margins_m"].values(), body["range_margin_m"])
    assert body["method"] == "closed_form"


def test_no_tumble_has_no_range_limit(client):
    body = client.get("/go-no-go", params={"omega_t_deg_s": 0, "a_max_m_s2": 0.1, "x_m": 0, "y_m": 90}).json()
    assert body["verdict"] == "GO"
    assert body["r_sync_m"] is None
    assert body["range_margin_m"] is None
    assert "does not tumble" in body["r_sync_reason"]


def test_outside_the_corridor_is_an_answer(client):
    body = client.get("/go-no-go", params={**POINT, "x_m": 90, "y_m": 10}).json()
    assert body["verdict"] == "NO_GO"
    assert body["violated_faces"] == ["right"]


coordinate = st.one_of(
    st.floats(-200, 200), st.floats(-10_000, 10_000), st.sampled_from([0.0, 0.5, 2.5, -2.5])
)


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(
    omega=st.one_of(st.just(0.0), st.floats(1e-6, 60.0)),
    thrust=st.floats(1e-4, 10.0),
    x=coordinate,
    y=coordinate,
    z=st.none() | coordinate,
    rest=st.sampled_from(list(Rest)),
    shape=st.just((1.5, 1.5, 2.5, 2.5, 0.5))
    | st.tuples(
        st.floats(0.01, 100), st.floats(0.01, 100), st.floats(0, 50), st.floats(0, 50), st.floats(0, 50)
    ),
)
def test_single_answer_is_the_certificate(client, omega, thrust, x, y, z, rest, shape):
    """GET in plain floats, certify in NumPy, and the process's own words: one answer."""
    query = {"omega_t_deg_s": omega, "a_max_m_s2": thrust, "x_m": x, "y_m": y, "rest": rest.value}
    query |= dict(zip(("c_x", "c_z", "x0_m", "z0_m", "r_h_m"), shape, strict=True))
    if z is not None:
        query["z_m"] = z
    answer = client.get(
        "/go-no-go", params={name: repr(v) if isinstance(v, float) else v for name, v in query.items()}
    )
    assert answer.status_code == 200, answer.text
    body = answer.json()

    scenario = Scenario(Target(math.radians(omega)), Chaser(thrust), CorridorShape(*shape))
    certificate = certify(scenario, np.array([x, y] if z is None else [x, y, z]), rest)
    assert body["verdict"] == ("GO" if certificate.safe else "NO_GO")
    assert body["margin_m"] == pytest.approx(float(certificate.margin), rel=1e-9, abs=1e-8)
    np.testing.assert_allclose(
        list(body["face_margins_m"].values()), certificate.face_margin, rtol=1e-9, atol=1e-8
    )
    limit = range_limit(scenario, rest)
    assert body["r_sync_m"] == (pytest.approx(limit) if math.isfinite(limit) else None)

    inputs = {name: query[name] for name in ("omega_t_deg_s", "a_max_m_s2", "rest")}
    inputs["corridor"] = {name: query[name] for name in ("c_x", "c_z", "x0_m", "z0_m", "r_h_m")}
    inputs["states"] = [{name: query[name] for name in ("x_m", "y_m", "z_m") if name in query}]
    words = run(GoNoGoInputs.model_validate(inputs), Context()).document
    assert body["binding"] == words["binding"][0]
    assert body["violated_faces"] == words["violated_faces"][0]
    # The sentence prints two decimals; a last bit may turn a rounding, so its numbers are compared as numbers.
    ours, theirs = body["reason"].split(), words["reason"][0].split()
    assert [w for w in ours if not _number(w)] == [w for w in theirs if not _number(w)]
    assert [float(w.strip("(")) for w in ours if _number(w)] == pytest.approx(
        [float(w.strip("(")) for w in theirs if _number(w)], rel=1e-9, abs=0.011
    )


def _number(word: str) -> bool:
    return word.strip("(").replace(".", "").replace("-", "").isdigit()


def test_go_no_go_many(client):
    states = [{"x_m": x, "y_m": 40} for x in range(-60, 61)]
    body = client.post("/go-no-go", json={**POINT, "states": states}).json()
    assert len(body["verdict"]) == len(states)
    for state, verdict in zip(states[::20], body["verdict"][::20], strict=True):
        assert client.get("/go-no-go", params={**POINT, **state}).json()["verdict"] == verdict


def test_hundred_thousand_states(client):
    rows = ",".join(f'{{"x_m":{i % 50},"y_m":{i % 150}}}' for i in range(100_000))
    body = f'{{"omega_t_deg_s":3,"a_max_m_s2":0.1,"states":[{rows}]}}'
    answer = client.post("/go-no-go", content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code == 200
    assert len(answer.json()["verdict"]) == 100_000


def test_certificates(client):
    body = client.post("/certificates", json={**POINT, "grid": {"nx": 31, "ny": 31, "y_max_m": 150}}).json()
    assert body["r_sync_m"] == pytest.approx(72.9513, abs=1e-4)
    assert np.array(body["mask"]).shape == np.array(body["margin_m"]).shape == (31, 31)
    assert 0 < body["safe_fraction"] < 1


# Processes


def test_process_list_and_description(client):
    listed = client.get("/processes").json()["processes"]
    assert [entry["id"] for entry in listed][:2] == ["go-no-go", "certificate"]
    for entry in listed:
        described = client.get(f"/processes/{entry['id']}").json()
        assert described["inputs"]
        assert described["outputs"]
        assert "$ref" not in json.dumps(described), "each schema stands alone"
        assert ("sync-execute" in described["jobControlOptions"]) == (
            entry["id"] in ("go-no-go", "certificate", "safe-region", "flight", "thrust-map")
        )
    required = client.get("/processes/certificate").json()["inputs"]
    assert required["omega_t_deg_s"]["minOccurs"] == 1
    assert required["grid"]["minOccurs"] == 0


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
    raw = client.post(url, json={"inputs": inputs, "outputs": {"verdict": {}}, "response": "raw"})
    assert raw.json() == ["GO"]
    assert_problem(client.post(url, json={"inputs": inputs, "outputs": {"nope": {}}}), 422, "outputs")
    assert_problem(client.post(url, json={"inputs": inputs, "response": "raw"}), 422, "response")


def test_heavy_execution_is_queued_with_its_certificate(queue):
    client, jobs = queue
    answer = client.post("/processes/benchmark/execution", json=HEAVY)
    assert answer.status_code == 201
    body = answer.json()
    assert answer.headers["location"] == f"http://testserver/jobs/{body['jobID']}"
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


def test_idempotency_key(queue):
    client, jobs = queue
    first = submit(client, **{"Idempotency-Key": "abc"})
    assert submit(client, **{"Idempotency-Key": "abc"}) == first
    other = client.post(
        "/processes/coverage/execution", json={"inputs": {}}, headers={"Idempotency-Key": "abc"}
    )
    assert_problem(other, 422, "Idempotency-Key")
    assert jobs.counts()["accepted"] == 1


def test_queue_cap(tmp_path):
    with service(tmp_path, max_queued=1) as client:
        submit(client)
        answer = client.post("/processes/benchmark/execution", json=HEAVY)
        assert_problem(answer, 429)
        assert int(answer.headers["retry-after"]) > 0


# Jobs


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


# Results


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


# Events


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
    for wrong in ("x", "-1", "1" * 30):
        assert_problem(
            client.get(f"/jobs/{job}/events", headers={"Last-Event-ID": wrong}), 422, "Last-Event-ID"
        )


# The service itself


def test_landing_conformance_and_operations(client):
    links = {link["rel"]: link["href"] for link in client.get("/").json()["links"]}
    assert client.get(links["service-desc"]).json()["openapi"].startswith("3.")
    browser = client.get("/", headers={"Accept": "text/html"}, follow_redirects=False)
    assert (browser.status_code, browser.headers["location"]) == (303, "http://testserver/dashboard")
    assert any(name.endswith("/conf/dismiss") for name in client.get("/conformance").json()["conformsTo"])
    assert client.get("/healthz").json()["status"] == "ok"
    text = client.get("/metrics").text
    assert 'safestart_http_requests_total{method="GET",route="/healthz",status="200"}' in text
    assert 'safestart_jobs{status="accepted"}' in text
    assert "safestart_workers_alive" in text


def test_ready_is_who_can_take_jobs(queue):
    """The database alone is not enough: a worker with a running cluster has to be there."""
    client, jobs = queue
    assert "0 workers" in assert_problem(client.get("/readyz"), 503)["detail"]
    jobs.heartbeat("starting", 0, 0)
    assert "1 workers" in assert_problem(client.get("/readyz"), 503)["detail"]
    jobs.heartbeat("one", 2, 1)
    body = client.get("/readyz").json()
    assert (body["status"], body["workers_alive"], body["places"], body["places_taken"]) == ("ready", 2, 2, 1)


def test_metrics_of_the_queue(queue):
    client, jobs = queue
    submit(client)
    submit(client)
    finish(jobs)
    jobs.heartbeat("one", 2, 1)
    claim = jobs.claim("one", 60.0)
    assert jobs.restarted(claim, 3)
    submit(client)
    text = client.get("/metrics").text
    for line in (
        'safestart_jobs{status="successful"} 1.0',
        "safestart_queue_depth 1.0",
        "safestart_places 2.0",
        "safestart_places_taken 1.0",
        "safestart_lease_losses_total 0.0",
        "safestart_task_deaths_total 1.0",
        "safestart_poisoned_total 0.0",
    ):
        assert f"\n{line}\n" in text, line
    for name in ("job_wait", "job_run"):
        assert f'safestart_{name}_seconds{{process="benchmark",quantile="0.5"}}' in text
    assert 0.0 <= float(re.search(r"\nsafestart_queue_oldest_wait_seconds (\S+)", text)[1]) < 60.0


def test_database_away(tmp_path):
    """The instant answers go on; readiness and jobs say 503; metrics say that the store is down."""
    folder = tmp_path / "gone"
    with service(folder) as client:
        assert client.get("/go-no-go", params={**POINT, "x_m": 5, "y_m": 40}).status_code == 200
        assert_problem(client.get("/readyz"), 503)
        assert_problem(client.get("/jobs"), 503)
        assert_problem(client.post("/processes/benchmark/execution", json=HEAVY), 503)
        assert "safestart_store_up 0.0" in client.get("/metrics").text


def test_pages(queue):
    client, jobs = queue
    job = submit(client)
    finish(jobs)
    places = ("", "/trade", "/submit", "/jobs", f"/jobs/{job}", "/compare")
    for path in (*(f"/dashboard{place}" for place in places), "/docs"):
        answer = client.get(path)
        assert answer.status_code == 200, path
        assert answer.headers["content-type"].startswith("text/html")
        policy = answer.headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe-inline" not in policy
        assert "unsafe-eval" not in policy
        assert len(answer.headers.get_list("content-security-policy")) == 1
        assert " style=" not in answer.text
        assert "<script>" not in answer.text, "no inline script"
        assert " on" not in re.sub(r">[^<]*<", "><", answer.text), "no inline handler"
        assert "//cdn" not in answer.text
        assert "analytical" not in answer.text, "a page holds no data of the store"


def test_files_of_the_pages(client):
    for name, kind in (
        ("safestart.css", "text/css"),
        ("explore.js", "text/javascript"),
        ("plotly.min.js", "text/javascript"),
    ):
        answer = client.get(f"/static/{name}")
        assert answer.headers["content-type"].startswith(kind)
        assert "script-src" not in answer.headers["content-security-policy"]
        again = client.get(f"/static/{name}", headers={"If-None-Match": answer.headers["etag"]})
        assert (again.status_code, again.content) == (304, b"")
    assert_problem(client.get("/static/..%2fapp.py"), 404)
    assert_problem(client.get("/static/app.py"), 404)


def test_arrays_as_json(queue):
    client, jobs = queue
    client.post("/processes/benchmark/execution", json=HEAVY)
    claim = jobs.claim("tester", 60.0)
    buffer = io.BytesIO()
    np.savez(buffer, mask=np.array([[True, False]]), margin_m=np.array([1.5, np.nan, np.inf]))
    files = (
        Artifact("maps.npz", "application/x-npz", buffer.getvalue()),
        Artifact("bad.npz", "application/x-npz", b"x"),
    )
    jobs.succeed(claim, {"outputs": {}}, (*files, Artifact("a.txt", "text/plain", b"x")), {})
    here = f"/jobs/{claim.job_id}/artifacts"
    answer = client.get(f"{here}/maps.npz/arrays")
    assert answer.json() == {"mask": [[True, False]], "margin_m": [1.5, None, None]}
    assert (
        client.get(f"{here}/maps.npz/arrays", headers={"If-None-Match": answer.headers["etag"]}).status_code
        == 304
    )
    assert client.get(f"{here}/maps.npz/arrays?names=mask").json() == {"mask": [[True, False]]}
    assert_problem(client.get(f"{here}/maps.npz/arrays?names=none"), 404, "names")
    assert_problem(client.get(f"{here}/bad.npz/arrays"), 422, "name")
    assert_problem(client.get(f"{here}/a.txt/arrays"), 422, "name")
