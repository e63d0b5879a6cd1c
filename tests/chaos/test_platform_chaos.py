"""The whole platform with everything real: service, two workers, their Dask processes; any of them is killed.

The short form kills one of each kind; the long one (``pytest -m chaos_long tests/chaos``) ten, on each database.
"""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from safestart.processes.execute import execute
from safestart.records.comparable import comparable
from tests.contract.store.store_backends import BACKENDS, POSTGRESQL, fresh_url
from tests.waiting import PATIENCE_S, free_port, until

JOBS = 30
KINDS = ("task process", "worker", "service")


class Platform:
    """``safestart up`` and a second worker on the same database, and a client that does not give up."""

    def __init__(self, url: str, folder: Path) -> None:
        port = free_port()
        environment = os.environ | {
            "SAFESTART_DATABASE_URL": url,
            "SAFESTART_LEASE_S": "5",
            "SAFESTART_PROCESSES": "1",
            # Kills are bad luck here and no poison.
            "SAFESTART_MAX_ATTEMPTS": "20",
        }
        self.log = folder / "platform.log"
        self._environment = environment
        self._parts: list[subprocess.Popen[bytes]] = []
        self._start("up", "--port", str(port))
        self._start("worker")
        self._client = httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60.0)
        self._random = random.Random(11)
        until(lambda: self.get("/readyz")["places"] == 2, "two workers", log=self.log)

    def _start(self, *arguments: str) -> None:
        with self.log.open("ab") as sink:
            command = [sys.executable, "-m", "safestart", *arguments]
            part = subprocess.Popen(command, env=self._environment, stdout=sink, stderr=sink)
        self._parts.append(part)

    def get(self, path: str) -> dict[str, Any]:
        return self._insist("GET", path)

    def submit(self, number: int) -> str:
        """Queue a job of a few tenths of a second; the key makes a repeated submission the same job."""
        body = {"inputs": inputs(number)}
        document = self._insist(
            "POST", "/processes/coverage/execution", json=body, headers={"Idempotency-Key": f"k{number}"}
        )
        return str(document["jobID"])

    def _insist(self, method: str, path: str, **more: Any) -> dict[str, Any]:
        deadline = time.monotonic() + PATIENCE_S
        while True:
            try:
                answer = self._client.request(method, path, **more)
                if answer.status_code not in (503, 429):
                    answer.raise_for_status()
                    document: dict[str, Any] = answer.json()
                    return document
            except httpx.TransportError:
                pass
            assert time.monotonic() < deadline, f"{path}: no answer\n{self.log.read_text()[-4000:]}"
            time.sleep(0.1)

    def kill(self, kind: str) -> None:
        """SIGKILL one process of this kind; restart a worker without a supervisor."""
        candidates = self._processes(kind)
        if not candidates:
            return
        victim = self._random.choice(candidates)
        victim.kill()
        second = self._parts[1]
        if victim.pid == second.pid:
            second.wait()
            del self._parts[1]
            self._start("worker")

    def _processes(self, kind: str) -> list[psutil.Process]:
        found = []
        for part in self._parts:
            family = psutil.Process(part.pid)
            for process in (family, *family.children(recursive=True)):
                try:
                    command = process.cmdline()
                except (psutil.NoSuchProcess, psutil.ZombieProcess):
                    continue
                if _kind(command) == kind:
                    found.append(process)
        return found

    def counts(self) -> Counter[str]:
        jobs = self.get("/jobs?limit=200")["jobs"]
        assert len(jobs) == JOBS
        return Counter(job["status"] for job in jobs)

    def close(self) -> None:
        for part in self._parts:
            part.terminate()
        for part in self._parts:
            part.wait(PATIENCE_S)
        self._client.close()


def _kind(command: list[str]) -> str | None:
    if command[1:4] == ["-m", "safestart", "worker"]:
        return "worker"
    if command[1:4] == ["-m", "safestart", "serve"]:
        return "service"
    return "task process" if any("spawn_main" in part for part in command) else None


def inputs(number: int) -> dict[str, Any]:
    grid = {"nx": 150, "ny": 150, "y_max_m": 150}
    rates = [1 + 0.01 * number + 0.5 * i for i in range(8)]
    return {"omega_t_deg_s": rates, "a_max_m_s2": [0.05, 0.1], "grid": grid}


def hammer(url: str, folder: Path, kills: int) -> None:
    platform = Platform(url, folder)
    try:
        ids = [platform.submit(number) for number in range(JOBS // 2)]
        for kill in range(kills):
            time.sleep(1.0)
            platform.kill(KINDS[kill % len(KINDS)])
            if kill == kills // 2:
                ids += [platform.submit(number) for number in range(JOBS // 2, JOBS)]
        until(lambda: platform.counts() == {"successful": JOBS}, "success of all", log=platform.log)
        assert len(set(ids)) == JOBS
        for number, job in enumerate(ids):
            document = platform.get(f"/jobs/{job}/results")
            if number % 10 == 0:
                expected = execute("coverage", inputs(number)).document
                assert comparable(document["outputs"]) == comparable(expected["outputs"])
        answer = platform._client.get(f"/jobs/{ids[0]}/events")
        assert answer.text.count('"status":"successful"') == 1
    finally:
        platform.close()


@pytest.fixture
def short_url(tmp_path: Path) -> str:
    return fresh_url("postgresql" if POSTGRESQL else "sqlite", tmp_path)


def test_one_process_of_each_kind_is_killed(short_url: str, tmp_path: Path) -> None:
    hammer(short_url, tmp_path, len(KINDS))


@pytest.mark.chaos_long
@pytest.mark.parametrize("backend", BACKENDS)
def test_ten_processes_are_killed(backend: str, tmp_path: Path) -> None:
    hammer(fresh_url(backend, tmp_path), tmp_path, 10)
