"""What the API says of the service itself: landing page, readiness, metrics, pages."""

from __future__ import annotations

import io
import re

import numpy as np

from safestart.records.artifact import Artifact
from tests.contract.api.service_client import (
    HEAVY,
    POINT,
    assert_problem,
    finish,
    service,
    submit,
)


def test_landing_conformance_and_operations(client):
    links = {link["rel"]: link["href"] for link in client.get("/").json()["links"]}
    assert client.get(links["service-desc"]).json()["openapi"].startswith("3.")
    browser = client.get("/", headers={"Accept": "text/html"}, follow_redirects=False)
    assert (browser.status_code, browser.headers["location"]) == (303, "http://127.0.0.1/dashboard")
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


def test_refusals_count(client):
    """What is refused before any route looks at it is in the metrics."""

    def count(status):
        line = rf'safestart_http_requests_total{{method="\*",route="\(none\)",status="{status}"}} (\S+)'
        found = re.search(line, client.get("/metrics").text)
        return float(found[1]) if found else 0.0

    before = {status: count(status) for status in (400, 413, 421)}
    client.get("/healthz", headers={"Host": "elsewhere.example"})
    client.get("/healthz", headers={"Host": "[::1]:99999"})
    client.post("/certificates", content=b" " * 9_000_000, headers={"Content-Type": "application/json"})
    assert {status: count(status) - number for status, number in before.items()} == {400: 1, 413: 1, 421: 1}


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
        asked = client.get("/readyz")
        assert "the database does not answer" in assert_problem(asked, 503)["detail"]
        assert str(folder) not in asked.text  # anybody may ask
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
        ("pages/explore.js", "text/javascript"),
        ("logic/store.js", "text/javascript"),
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
