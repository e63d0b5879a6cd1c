"""``safestart up`` in a process tree of its own, and a client of it."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import psutil

from tests.waiting import PATIENCE_S, free_port, until

PATIENT = {"SAFESTART_ANSWER_TIMEOUT_S": str(PATIENCE_S)}
"""On a busy machine an answer takes longer than a user would wait."""


@contextmanager
def serving(database_url: str) -> Iterator[str]:
    """``safestart serve`` alone; yields its address."""
    url = f"http://127.0.0.1:{free_port()}"
    command = [sys.executable, "-m", "safestart", "serve", "--port", url.rpartition(":")[2]]
    process = subprocess.Popen(command, env=PATIENT | os.environ | {"SAFESTART_DATABASE_URL": database_url})
    try:
        until(lambda: answers(url, process), "a service that answers")
        yield url
    finally:
        process.terminate()
        process.wait(PATIENCE_S)


def answers(url: str, process: subprocess.Popen[bytes]) -> bool:
    """True when the service answers there; its process must live."""
    assert process.poll() is None
    try:
        return httpx.get(f"{url}/healthz").is_success
    except httpx.TransportError:
        return False


class Running:
    """``safestart up`` and a client of it."""

    def __init__(self, folder: Path, lease_s: float = 20.0) -> None:
        """A short lease lets a killed worker's job be taken over soon; on a busy machine a living one loses it too."""
        port = free_port()
        self.database_url = f"sqlite:///{folder / 'up.sqlite3'}"
        environment = (
            PATIENT
            | os.environ
            | {
                "SAFESTART_DATABASE_URL": self.database_url,
                "SAFESTART_LEASE_S": f"{lease_s:g}",
                "SAFESTART_PROCESSES": "2",
            }
        )
        self.log = folder / "up.log"
        with self.log.open("wb") as sink:
            command = [sys.executable, "-m", "safestart", "up", "--port", str(port)]
            self.process = subprocess.Popen(command, env=environment, stdout=sink, stderr=sink)
        self.url = f"http://127.0.0.1:{port}"
        self.client = httpx.Client(base_url=self.url, timeout=PATIENCE_S)
        self.until(lambda: self.get("/readyz") is not None, "ready")

    def get(self, path: str) -> Any:
        try:
            response = self.client.get(path)
        except httpx.TransportError:
            return None
        return response.json() if response.is_success else None

    def until(self, true: Any, what: str) -> Any:
        def there() -> Any:
            assert self.process.poll() is None, self.log.read_text()
            return true()

        return until(there, what, log=self.log)

    def submit(self, inputs: dict[str, Any], process: str = "benchmark") -> str:
        answer = self.client.post(f"/processes/{process}/execution", json={"inputs": inputs})
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
        self.process.wait(PATIENCE_S)
        _, alive = psutil.wait_procs(family, timeout=60)
        self.client.close()
        return alive
