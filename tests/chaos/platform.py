"""The whole platform with everything real: service, two workers, their Dask processes; any of them is killed."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import httpx
import psutil

from tests.waiting import PATIENCE_S, free_port, until

KINDS = ("task process", "worker", "service")


class Platform:
    """``safestart up`` and a second worker on the same database, and a client that does not give up."""

    def __init__(self, url: str, folder: Path, settings: dict[str, str] | None = None) -> None:
        port = free_port()
        environment = os.environ | {
            "SAFESTART_DATABASE_URL": url,
            "SAFESTART_LEASE_S": "5",
            "SAFESTART_PROCESSES": "1",
            # Kills are bad luck here and no poison.
            "SAFESTART_MAX_ATTEMPTS": "20",
            **(settings or {}),
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

    def submit(self, process: str, inputs: dict[str, Any], key: str) -> str:
        """Queue a job and give its id; the key makes a repeated submission the same job."""
        headers = {"Idempotency-Key": key, "Prefer": "respond-async"}
        body = {"inputs": inputs}
        document = self._insist("POST", f"/processes/{process}/execution", json=body, headers=headers)
        return str(document["jobID"])

    def events(self, job: str) -> str:
        """The whole event stream of a job that has ended."""
        return self._client.get(f"/jobs/{job}/events").text

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
        candidates = self.processes(kind)
        if not candidates:
            return
        victim = self._random.choice(candidates)
        victim.kill()
        second = self._parts[1]
        if victim.pid == second.pid:
            second.wait()
            del self._parts[1]
            self._start("worker")

    def processes(self, kind: str) -> list[psutil.Process]:
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
