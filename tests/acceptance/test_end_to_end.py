"""The main job over HTTP with everything real: ``safestart up``, a queued benchmark, and processes killed under it."""

from collections.abc import Iterator
from typing import Any

import pytest
from owslib.ogcapi.processes import Processes

from safestart.records.comparable import comparable
from tests.acceptance.running import Running

INPUTS = {
    "omega_t_deg_s": 3,
    "a_max_m_s2": 0.1,
    "grid": {"nx": 31, "ny": 31, "y_max_m": 150},
    "horizon_s": 60,
    "engines": ["analytical", "exact", "backward", "forward", "hamilton_jacobi", "monte_carlo"],
    "hamilton_jacobi": {"frame": "body", "accuracy": "very_high"},
    "seed": 7,
}
"""The body frame takes more time steps: long enough to be killed in the middle."""


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    up = Running(tmp_path_factory.mktemp("up"), lease_s=4.0)
    yield up
    assert up.stop() == [], "Ctrl-C stops every child"


@pytest.fixture(scope="module")
def undisturbed(running: Running) -> dict[str, Any]:
    return running.outcome(running.submit(INPUTS))


def same(one: dict[str, Any], two: dict[str, Any]) -> None:
    assert comparable(one["outputs"]) == comparable(two["outputs"])
    assert one["inputs"] == two["inputs"]
    assert one["provenance"]["artifacts"] == two["provenance"]["artifacts"], (
        "pictures and arrays, byte for byte"
    )


def test_certificate_at_once_and_job_queued(running: Running) -> None:
    answer = running.client.post(
        "/processes/benchmark/execution", json={"inputs": INPUTS | {"engines": ["analytical"]}}
    )
    body = answer.json()
    assert answer.status_code == 201
    assert body["status"] == "accepted"
    assert body["certificate"]["r_sync_m"] == pytest.approx(72.951, abs=1e-3)
    assert len(body["certificate"]["mask"]) == 31
    running.outcome(body["jobID"])


def test_result_is_stored_and_readable(running: Running, undisturbed: dict[str, Any]) -> None:
    rows = {row["engine"]: row for row in undisturbed["outputs"]["rows"]}
    assert all(row["code"] == "ok" for row in rows.values())
    assert rows["exact"]["iou_vs_exact"] == 1.0
    assert set(rows["hamilton_jacobi"]["confusion"]) >= {"tp", "fp", "fn", "tn"}
    assert undisturbed["provenance"]["seed"] == 7


def test_survives_kill_of_a_dask_worker_process(running: Running, undisturbed: dict[str, Any]) -> None:
    job = running.submit(INPUTS)
    running.until(lambda: running.under_way(job), "under way")
    running.busiest("spawn_main").kill()
    same(running.outcome(job), undisturbed)


def test_survives_kill_of_the_whole_worker(running: Running, undisturbed: dict[str, Any]) -> None:
    job = running.submit(INPUTS)
    running.until(lambda: running.under_way(job), "under way")
    for process in running.processes("worker"):
        if process.cmdline()[1:4] == ["-m", "safestart", "worker"]:
            process.kill()
            break
    else:
        pytest.fail("no worker process found")
    same(running.outcome(job), undisturbed)
    assert running.get(f"/jobs/{job}")["attempts"] == 2
    assert "worker ended (signal 9, SIGKILL)" in running.log.read_text()


def test_a_standard_client_lists_describes_executes_follows_and_reads(running: Running) -> None:
    """OWSLib knows OGC API - Processes 1.0 and nothing of us."""
    client = Processes(str(running.client.base_url))
    assert client.api()["openapi"].startswith("3.0"), "it looks for a description of this version"
    assert "benchmark" in {entry["id"] for entry in client.processes()}
    described = client.process("benchmark")
    assert "async-execute" in described["jobControlOptions"]
    assert described["inputs"]["omega_t_deg_s"]["minOccurs"] == 1

    inputs = described["example"] | {"engines": ["analytical", "exact"], "grid": {"nx": 11, "ny": 11}}
    submitted = client.execute("benchmark", inputs=inputs, async_=True)
    job = submitted["jobID"]
    status = running.until(lambda: _ended(client._request(path=f"jobs/{job}")), "ended")
    assert status["status"] == "successful"
    assert job in {entry["jobID"] for entry in client._request(path="jobs")["jobs"]}
    results = client._request(path=f"jobs/{job}/results")
    assert [row["code"] for row in results["outputs"]["rows"]] == ["ok", "ok"]

    light = client.process("certificate")
    at_once = client.execute("certificate", inputs=light["example"], outputs={"r_sync_m": {}})
    assert at_once["r_sync_m"] == pytest.approx(72.951, abs=1e-3)


def _ended(status: dict[str, Any]) -> Any:
    return status["status"] in ("successful", "failed", "dismissed") and status
