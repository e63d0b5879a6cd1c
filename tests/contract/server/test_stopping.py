"""A service that is told to stop says so to whom it owes an answer; what is killed beneath it comes back."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from tests.acceptance.running import PATIENT
from tests.acceptance.worker_process import over
from tests.contract.api.service_client import POINT, assert_problem
from tests.waiting import PATIENCE_S, until

QUICK: dict[str, Any] = {**POINT, "x_m": 5, "y_m": 40, "method": "exact"}
LONG: dict[str, Any] = {"inputs": POINT | {"horizon_s": 600}}


@dataclass
class Served:
    process: subprocess.Popen[str]
    client: httpx.Client
    said: Path

    def helpers(self) -> list[psutil.Process]:
        return psutil.Process(self.process.pid).children(recursive=True)

    def busy(self) -> bool:
        """A helper has computed for a while."""
        return any(sum(one.cpu_times()[:2]) > 0.5 for one in self.helpers()[1:])


@pytest.fixture
def served(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Served]:
    for name, value in PATIENT.items():
        monkeypatch.setenv(name, value)
    said = tmp_path / "said"
    with said.open("w") as sink:
        command = [sys.executable, "-m", "safestart", "serve", "--port", "0", "--database-url"]
        address = f"sqlite:///{tmp_path / 'service.sqlite3'}"
        process = subprocess.Popen([*command, address], stdout=subprocess.PIPE, stderr=sink, text=True)
    assert process.stdout is not None
    base = process.stdout.readline().split()[1]
    with httpx.Client(base_url=base, timeout=PATIENCE_S) as client:
        until(lambda: client.get("/go-no-go", params=QUICK).status_code == 200, "a helper process")
        yield Served(process, client, said)
    process.kill()
    process.wait()


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_an_answer_that_is_not_there_when_the_service_stops(served: Served, how: signal.Signals) -> None:
    """It was a bare 500, or nothing at all, with a traceback in the log."""
    family = served.helpers()
    with ThreadPoolExecutor(1) as beside:
        answer = beside.submit(served.client.post, "/processes/safe-region/execution", json=LONG)
        until(served.busy, "a helper that computes")
        served.process.send_signal(how)
        problem = assert_problem(answer.result(), 503)
    assert problem["detail"] == "the service stops; required the same request later"
    assert int(answer.result().headers["retry-after"]) > 0
    served.process.wait(PATIENCE_S)
    assert "Traceback" not in served.said.read_text()
    until(lambda: over(family), "the end of its processes")


def test_what_is_killed_beneath_the_service_comes_back(served: Served) -> None:
    """Also the process that forks the others: its successor loads in nobody's time for an answer."""
    for which in (slice(1, None), slice(0, 1), slice(None)):
        killed = served.helpers()[which]
        for one in killed:
            one.kill()
        until(lambda those=killed: over(those), "their end")
        with ThreadPoolExecutor(3) as three:
            answers = list(three.map(lambda _: served.client.get("/go-no-go", params=QUICK), range(3)))
        assert [answer.status_code for answer in answers] == [200, 200, 200]
        assert len({answer.json()["margin_m"] for answer in answers}) == 1
