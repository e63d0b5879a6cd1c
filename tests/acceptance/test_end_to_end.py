"""The main job over HTTP with everything real: ``safestart up``, a queued benchmark, and processes killed under it."""

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from safestart.comparable import comparable

INPUTS = {
    "omega_t_deg_s": 3,
    "a_max_m_s2": 0.1,
    "grid": {"nx": 31, "ny": 31, "y_max_m": 150},
    "horizon_s": 60,
    "engines": ["analytical", "exact", "backward", "forward", "hamilton_jacobi", "monte_carlo"],
    "hamilton_jacobi": {"frame": "body", "accuracy": "low"},
    "seed": 7,
}
"""The body frame takes more time steps: long enough to be killed in the middle."""
LIMIT_S = 240.0


class Running:
    """``safestart up`` and a client of it."""

    def __init__(self, folder: Path) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        environment = os.environ | {
            "SAFESTART_DATABASE_URL": f"sqlite:///{folder / 'up.sqlite3'}",
            "SAFESTART_LEASE_S": "4",
            "SAFESTART_PROCESSES": "2",
        }
        self.log = folder / "up.log"
        with self.log.open("wb") as sink:
            command = [sys.executable, "-m", "safestart", "up", "--port", str(port)]
            self.process = subprocess.Popen(command, env=environment, stdout=sink, stderr=sink)
        self.client = httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=30.0)
        self.until(lambda: self.get("/readyz") is not None, "ready")

    def get(self, path: str) -> Any:
        try:
            response = self.client.get(path)
        except httpx.TransportError:
            return None
        return response.json() if response.is_success else None

    def until(self, true: Any, what: str, limit: float = LIMIT_S) -> Any:
        end = time.monotonic() + limit
        while time.monotonic() < end:
            value = true()
            if value:
                return value
            assert self.process.poll() is None, self.log.read_text()
            time.sleep(0.1)
        pytest.fail(f"not {what} within {limit} s\n{self.log.read_text()}")

    def submit(self, inputs: dict[str, Any]) -> str:
        answer = self.client.post("/processes/benchmark/execution", json={"inputs": inputs})
        assert answer.status_code == 201, answer.text
        job: str = answer.json()["jobID"]
        assert answer.headers["Location"].endswith(f"/jobs/{job}")
        return job

    def under_way(self, job: str) -> Any:
        status = self.get(f"/jobs/{job}")
        return status and status["status"] == "running" and status["progress"] > 15 and status

    def outcome(self, job: str) -> dict[str, Any]:
        def ended() -> Any:
            status = self.get(f"/jobs/{job}")
            return status and status["status"] in ("successful", "failed", "dismissed") and status

        status = self.until(ended, "ended")
        assert status["status"] == "successful", f"{status}\n{self.log.read_text()}"
        document: dict[str, Any] = self.get(f"/jobs/{job}/results")
        return document

    def processes(self, word: str) -> list[psutil.Process]:
        found = []
        for process in psutil.Process(self.process.pid).children(recursive=True):
            try:
                if any(word in part for part in process.cmdline()):
                    found.append(process)
            except psutil.NoSuchProcess:
                continue
        return found

    def busiest(self, word: str) -> psutil.Process:
        """The process that is working right now."""
        candidates = self.processes(word)
        before = {p.pid: sum(p.cpu_times()[:2]) for p in candidates}
        time.sleep(0.5)
        return max(candidates, key=lambda p: sum(p.cpu_times()[:2]) - before[p.pid])

    def stop(self) -> list[psutil.Process]:
        family = psutil.Process(self.process.pid).children(recursive=True)
        self.process.terminate()
        self.process.wait(timeout=60)
        _, alive = psutil.wait_procs(family, timeout=10)
        self.client.close()
        return alive


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    up = Running(tmp_path_factory.mktemp("up"))
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
    running.client.get("/healthz")
    start = time.monotonic()
    answer = running.client.post(
        "/processes/benchmark/execution", json={"inputs": INPUTS | {"engines": ["analytical"]}}
    )
    elapsed = time.monotonic() - start
    body = answer.json()
    assert answer.status_code == 201
    assert body["status"] == "accepted"
    assert body["certificate"]["r_sync_m"] == pytest.approx(72.951, abs=1e-3)
    assert len(body["certificate"]["mask"]) == 31
    assert elapsed < 1.0
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
    assert "worker" in running.log.read_text()
