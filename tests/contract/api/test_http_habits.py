"""Entity tags, formats by Accept, long polls, filters, HEAD: the habits of the API that no single call owns."""

from __future__ import annotations

import csv
import io
import threading
import time
from typing import Any

import numpy as np
import pytest

from safestart.errors import SafestartError
from safestart.records import parquet
from safestart_service.documents.formats.ogc import ogc_results
from safestart_service.documents.formats.registry import BY_TYPE
from safestart_service.http.negotiation import chosen
from tests.contract.api.service_client import POINT, assert_problem, finish, submit
from tests.contract.store.store_backends import pass_time
from tests.waiting import PATIENCE_S

RECORD = "application/vnd.safestart.result+json"
OUTPUTS = {
    "rows": [
        {
            "engine": "exact",
            "area_m2": 12.5,
            "cells": 3,
            "confusion": {"tp": 1, "fp": 0},
            "faces": ["left", "right"],
        },
        {"engine": 'no, "comma"', "area_m2": None, "cells": 4.5, "confusion": None, "faces": []},
    ],
    "mask": [[True, False], [False, True]],
    "margin_m": [[0.5, None], [1.0, 2.0]],
    "notes": ["a", "b"],
    "cell_area_m2": 2.5,
    "horizon_s": None,
    "bounds": {"lower": 1.0},
}


@pytest.fixture
def done(queue):
    """A successful job with outputs of every kind."""
    client, jobs = queue
    job = submit(client)
    claim = jobs.claim("tester", 60.0)
    assert claim is not None
    jobs.succeed(claim, {"inputs": claim.inputs, "outputs": OUTPUTS, "provenance": {}}, (), {})
    return client, f"/jobs/{job}/results"


@pytest.mark.parametrize(
    ("accept", "expected"),
    [
        (None, RECORD),
        ("", RECORD),
        ("*/*", RECORD),
        ("text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8", RECORD),
        ("application/json", "application/json"),
        ("application/json, text/plain, */*", "application/json"),
        ("TEXT/CSV", "text/csv"),
        ("text/*", "text/csv"),
        ("text/csv;q=0.2, application/x-npz;q=0.9", "application/x-npz"),
        ("application/*;q=0.3, text/csv;q=0.2", RECORD),
        ("*/*, application/json;q=0", RECORD),
    ],
)
def test_negotiation(accept, expected):
    assert chosen(accept, list(BY_TYPE)) == expected


@pytest.mark.parametrize("accept", ["image/png", "text/csv;q=0", "text/csv;q=none", "nonsense", ";;,"])
def test_nothing_acceptable(accept):
    with pytest.raises(SafestartError, match="Accept: required one of") as refused:
        chosen(accept, list(BY_TYPE))
    assert refused.value.status == 406


def test_results_by_accept(done):
    client, path = done
    record = client.get(path)
    assert record.headers["content-type"] == RECORD
    assert record.headers["vary"] == "Accept"
    tags = {record.headers["etag"]}

    ogc = client.get(path, headers={"Accept": "application/json"})
    assert ogc.headers["content-type"] == "application/json"
    assert ogc.json() == ogc_results(record.json())
    assert ogc.json()["bounds"] == {"value": {"lower": 1.0}, "mediaType": "application/json"}
    assert "horizon_s" not in ogc.json()
    tags.add(ogc.headers["etag"])

    table = client.get(path, headers={"Accept": "text/csv"})
    rows = list(csv.DictReader(io.StringIO(table.text)))
    assert rows[0] == {
        "engine": "exact",
        "area_m2": "12.5",
        "cells": "3.0",
        "confusion.tp": "1",
        "confusion.fp": "0",
        "faces": "left right",
    }, "no column for what is only an object or nothing"
    assert rows[1]["engine"] == 'no, "comma"'
    assert rows[1]["area_m2"] == ""
    tags.add(table.headers["etag"])

    arrays = client.get(path, headers={"Accept": "application/x-npz"})
    with np.load(io.BytesIO(arrays.content), allow_pickle=False) as found:
        np.testing.assert_array_equal(found["mask"], OUTPUTS["mask"])
        assert found["mask"].dtype == bool
        np.testing.assert_array_equal(found["margin_m"], [[0.5, np.nan], [1.0, 2.0]])
        np.testing.assert_array_equal(found["rows.area_m2"], [12.5, np.nan])
        assert float(found["cell_area_m2"]) == 2.5
        assert "notes" not in found
    tags.add(arrays.headers["etag"])

    columns = client.get(f"{path}?format=parquet")

    read = parquet.read(columns.content).to_pylist()
    assert [row["area_m2"] for row in read] == [12.5, None]
    assert [row["cells"] for row in read] == [3.0, 4.5]
    tags.add(columns.headers["etag"])

    assert len(tags) == 5, "each form has a tag of its own"
    for answer, accept in ((record, "*/*"), (ogc, "application/json"), (table, "text/csv")):
        again = client.get(path, headers={"Accept": accept, "If-None-Match": answer.headers["etag"]})
        assert (again.status_code, again.content) == (304, b"")
        assert again.headers["vary"] == "Accept", "or a cache gives the table to who wants the record"
    crossed = client.get(path, headers={"Accept": "text/csv", "If-None-Match": record.headers["etag"]})
    assert crossed.status_code == 200
    assert_problem(client.get(path, headers={"Accept": "image/png"}), 406, "Accept")
    assert_problem(client.get(f"{path}?format=csv&table=nope"), 422, "table")
    assert_problem(client.get(f"{path}?format=xml"), 422, "format")


def test_entity_tags_on_documents(queue):
    client, jobs = queue
    job = submit(client)
    for path in (
        "/processes",
        "/processes/benchmark",
        "/conformance",
        "/openapi.json",
        "/jobs",
        f"/jobs/{job}",
    ):
        first = client.get(path)
        again = client.get(path, headers={"If-None-Match": first.headers["etag"]})
        assert (again.status_code, again.content) == (304, b""), path
    before = client.get(f"/jobs/{job}").headers["etag"]
    finish(jobs)
    after = client.get(f"/jobs/{job}", headers={"If-None-Match": before})
    assert after.status_code == 200
    assert after.json()["status"] == "successful"


def test_head_is_get_without_its_body(queue):
    client, _ = queue
    for path in ("/", "/jobs", "/processes/benchmark", "/healthz", "/dashboard"):
        answer = client.head(path)
        assert answer.status_code == 200, path
        assert answer.headers["content-type"] == client.get(path).headers["content-type"]
    assert client.head("/nothing").status_code == 404
    assert client.head("/jobs/x/events").status_code == 405, "a stream has no head to be had alone"


def test_options_and_allow_name_every_method(queue):
    client, _ = queue
    for path, allowed in (
        ("/jobs", "GET, HEAD, OPTIONS"),
        ("/jobs/x", "DELETE, GET, HEAD, OPTIONS, PATCH"),
        ("/jobs/x/events", "GET, OPTIONS"),
        ("/processes/benchmark/execution", "OPTIONS, POST"),
    ):
        answer = client.options(path)
        assert (answer.status_code, answer.headers["allow"], answer.content) == (204, allowed, b"")
        refused = client.request("PUT", path)
        assert_problem(refused, 405)
        assert refused.headers["allow"] == allowed
    assert_problem(client.options("/nothing"), 404)


# Long polls


def test_wait_ends_with_the_job(queue):
    client, jobs = queue
    job = submit(client)
    worker = threading.Timer(0.5, finish, args=(jobs,), kwargs={"progress": False})
    start = time.monotonic()
    worker.start()
    answer = client.get(f"/jobs/{job}?wait=30").json()
    elapsed = time.monotonic() - start
    worker.join()
    assert answer["status"] == "successful"
    assert 0.5 <= elapsed < 30


def test_wait_ends_in_time(queue):
    client, _ = queue
    job = submit(client)
    start = time.monotonic()
    assert client.get(f"/jobs/{job}?wait=0.6").json()["status"] == "accepted"
    assert 0.5 < time.monotonic() - start < 30
    for wrong in ("-1", "31", "nan", "x"):
        assert_problem(client.get(f"/jobs/{job}?wait={wrong}"), 422, "wait")
    assert_problem(client.get("/jobs/nope?wait=20"), 404)


def test_wait_for_any_change(queue):
    client, jobs = queue
    job = submit(client)
    tag = client.get(f"/jobs/{job}").headers["etag"]
    unchanged = client.get(f"/jobs/{job}?wait=0.4", headers={"If-None-Match": tag})
    assert unchanged.status_code == 304
    worker = threading.Timer(0.4, jobs.claim, args=("tester", 60.0))
    worker.start()
    changed = client.get(f"/jobs/{job}?wait=30", headers={"If-None-Match": tag})
    worker.join()
    assert changed.json()["status"] == "running"


# Filters


def test_job_filters(queue):
    client, jobs = queue
    first, second, third = submit(client), submit(client), submit(client)
    claim = jobs.claim("tester", 60.0)
    assert claim is not None
    pass_time(client.app.state.services.database, PATIENCE_S)
    jobs.succeed(claim, {"outputs": {}}, (), {})
    running = jobs.claim("tester", 60.0)
    assert running is not None

    def of(**query: Any) -> set[str]:
        answer = client.get("/jobs", params=query)
        assert answer.status_code == 200, answer.text
        return {job["jobID"] for job in answer.json()["jobs"]}

    assert of(minDuration=PATIENCE_S) == {first}
    assert of(maxDuration=PATIENCE_S - 1) == {second}
    assert of(minDuration=0, maxDuration=10 * PATIENCE_S) == {first, second}, (
        "one that never started has no duration"
    )
    assert of(type="process") == {first, second, third}
    created = client.get(f"/jobs/{second}").json()["created"].replace("+00:00", "Z")
    assert of(datetime=created) == {second}
    assert of(datetime=f"{created}/..") == {second, third}
    assert of(datetime=f"../{created}") == {first, second}
    assert of(datetime=f"/{created}") == {first, second}
    assert of(datetime="2000-01-01T00:00:00Z/2000-01-02T00:00:00Z") == set()
    assert of(datetime="2000-01-01T01:00:00+02:00/..") == {first, second, third}
    assert of(submitter="0123456789ab") == set()


@pytest.mark.parametrize(
    "text",
    [
        "now",
        "..",
        "../..",
        "/",
        "2026-11-22",
        "2026-11-22T00:00:00",
        "2026-11-22T00:00:00Z/2026-11-21T00:00:00Z",
        "2026-11-22T00:00:00Z/2026-11-22T00:00:00Z/..",
        "0001-01-01T00:00:00+23:59",
        "9999-12-31T23:59:59-23:59",
    ],
)
def test_wrong_intervals(queue, text):
    client, _ = queue
    assert_problem(client.get("/jobs", params={"datetime": text}), 422, "datetime")


def test_paging_keeps_its_filters(queue):
    client, _ = queue
    made = [submit(client) for _ in range(5)]
    seen: list[str] = []
    url: str | None = "/jobs?limit=2&datetime=2000-01-01T00:00:00Z/..&status=accepted"
    while url:
        page = client.get(url).json()
        seen += [job["jobID"] for job in page["jobs"]]
        url = next((link["href"] for link in page["links"] if link["rel"] == "next"), None)
        assert url is None or "datetime=" in url
    assert seen == made[::-1]


def test_request_ids_are_in_problems_and_answers(queue):
    client, _ = queue
    for path in ("/nothing", "/jobs/x", "/go-no-go", "/healthz?x=" + "1" * 9000):
        answer = client.get(path, headers={"X-Request-ID": "trace-1"})
        assert answer.json()["request_id"] == answer.headers["x-request-id"] == "trace-1"
    made = client.post("/certificates", json={**POINT, "x": 1})
    assert made.json()["request_id"] == made.headers["x-request-id"]
