"""A job's bundle over the API: what the command writes, for jobs that have ended."""

from __future__ import annotations

import pytest

from safestart.records.bundle import pack, unpack
from safestart.store.database import Database
from safestart.store.transfer import Transfer
from safestart_service.routes import results
from tests.contract.api.service_client import SMALL, assert_problem, submit, url_of


@pytest.fixture
def done(queue, execution):
    """A client, and the id of a job that ended as a worker ends it."""
    client, jobs = queue
    job = client.post("/processes/benchmark/execution", json={"inputs": SMALL, "name": "kept"}).json()[
        "jobID"
    ]
    claim = jobs.claim("tester", 60.0)
    jobs.succeed(claim, execution.document, execution.artifacts, {})
    return client, job


def test_it_is_the_bundle_of_the_command(done, tmp_path):
    client, job = done
    answer = client.get(f"/jobs/{job}/bundle")
    assert answer.status_code == 200, answer.text
    data, seal = pack(Transfer(Database(url_of(tmp_path))).read(job))
    assert answer.content == data
    assert answer.headers["Safestart-Seal"] == seal
    assert answer.headers["Content-Disposition"] == f'attachment; filename="{job}.zip"'
    assert unpack(answer.content, seal).job["name"] == "kept"


def test_what_is_not_packed_is_refused(done, monkeypatch):
    client, job = done
    assert_problem(client.get("/jobs/nothing/bundle"), 404)
    assert_problem(client.get(f"/jobs/{submit(client)}/bundle"), 409)
    monkeypatch.setattr(results, "MOST_BUNDLED", 10)
    assert "safestart export" in assert_problem(client.get(f"/jobs/{job}/bundle"), 409)["detail"]
