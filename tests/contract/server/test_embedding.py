"""The application in other programs: made before a fork, started twice, never started, without a place for files."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from safestart.runtime.settings import Settings
from safestart_service.app import create_app
from safestart_service.computing import heavy
from tests.contract.api.service_client import url_of
from tests.waiting import PATIENCE_S, accepts, ended, free_port, until

BASE = "http://127.0.0.1:8000"
MANY = [{"x_m": 1e-4 * k, "y_m": 40.0} for k in range(20_000)]
# Long enough for a helper process, and its answer for a file.
HEAVY = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "method": "paper", "states": MANY}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where files of long answers are made, and nothing else."""
    found = tmp_path / "files"
    found.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(found))
    monkeypatch.setattr(heavy, "START_S", PATIENCE_S)
    return found


def app_of(tmp_path: Path) -> FastAPI:
    return create_app(Settings(database_url=url_of(tmp_path), answer_timeout_s=PATIENCE_S))


def asked(client: Any, **more: Any) -> httpx.Response:
    answer: httpx.Response = client.post("/go-no-go", json=HEAVY | more, timeout=PATIENCE_S)
    return answer


def test_an_application_that_ended_begins_again(tmp_path: Path, folder: Path) -> None:
    app = app_of(tmp_path)
    for _ in range(2):
        with TestClient(app, base_url=BASE, client=("127.0.0.1", 1)) as client:
            assert client.get("/go-no-go?omega_t_deg_s=3&a_max_m_s2=0.1&x_m=0&y_m=40").status_code == 200
            assert asked(client).status_code == 200
            assert client.get("/jobs").status_code == 200
            app.state.services.helpers.leave()  # as a service does that stops
    assert not list(folder.iterdir())


def test_an_application_that_never_began_answers(tmp_path: Path, folder: Path) -> None:
    app = app_of(tmp_path)
    client = TestClient(app, base_url=BASE, client=("127.0.0.1", 1))  # an event loop for each request
    try:
        assert [asked(client).status_code for _ in range(3)] == [200, 200, 200]
        stored = client.get("/jobs")
        assert stored.status_code == 503
        assert "app.router.lifespan_context" in stored.json()["detail"]
        assert not list(folder.iterdir())
    finally:
        app.state.services.close()


@pytest.mark.parametrize("how", ["gone", "a file", "not to be written"])
def test_a_long_answer_needs_no_place_for_files(tmp_path: Path, folder: Path, how: str) -> None:
    with TestClient(app_of(tmp_path), base_url=BASE, client=("127.0.0.1", 1)) as client:
        whole = asked(client)
        assert whole.status_code == 200
        assert len(whole.content) > 1_000_000
        folder.rmdir()
        if how == "a file":
            folder.touch()
        elif how == "not to be written":
            folder.symlink_to("/proc")
        again = asked(client)
        assert again.status_code == 200
        assert again.content == whole.content


PREFORKED = """
import os, socket, sys
import uvicorn
from safestart.runtime.settings import Settings
from safestart_service.app import create_app
app = create_app(Settings(database_url=sys.argv[1], answer_timeout_s=300))
children = []
for port in sys.argv[2:]:
    child = os.fork()
    if child == 0:
        uvicorn.run(app, host="127.0.0.1", port=int(port), log_level="warning")
        os._exit(0)
    children.append(child)
print(*children, flush=True)
for child in children:
    os.waitpid(child, 0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
def test_services_that_were_forked_from_one_answer_their_own_clients(tmp_path: Path) -> None:
    """Both gave their files the same names: one client got the answer of the other's."""
    ports = [free_port(), free_port()]
    command = [sys.executable, "-c", PREFORKED, url_of(tmp_path), *map(str, ports)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        children = [int(pid) for pid in parent.stdout.readline().split()]
        try:
            rates = dict(zip(ports, (3.0, 5.0), strict=True))
            for port in ports:
                until(lambda port=port: accepts(port), f"a service at {port}")

            def answer(port: int) -> Any:
                base = f"http://127.0.0.1:{port}"
                with httpx.Client(base_url=base, trust_env=False) as client:
                    found = asked(client, omega_t_deg_s=rates[port])
                assert found.status_code == 200, found.text[:500]
                return found.content

            alone = [answer(port) for port in ports]
            assert alone[0] != alone[1]
            with ThreadPoolExecutor(2) as threads:
                for _ in range(8):
                    assert list(threads.map(answer, ports)) == alone
        finally:
            for pid in children:
                os.kill(pid, 15)
    until(lambda: all(map(ended, children)), "the end of both")


USED_THEN_FORKED = """
import asyncio, os, sys
import httpx
from safestart.runtime.settings import Settings
from safestart_service.app import create_app
from safestart_service.computing import heavy
heavy.START_S = 300
QUESTION = "/go-no-go?omega_t_deg_s=2&a_max_m_s2=0.05&method=exact&"
GO, NO_GO = "x_m=5&y_m=40", "x_m=9.364&y_m=81.044"
app = create_app(Settings(database_url=sys.argv[1], answer_timeout_s=60))
app.state.services.database.migrate()
app.state.services.keyring.load()
async def verdicts(start):
    here = httpx.ASGITransport(app=app, client=("127.0.0.1", 1))
    async with httpx.AsyncClient(transport=here, base_url="http://127.0.0.1", timeout=300) as client:
        found = []
        for _ in range(4):
            answers = await asyncio.gather(*(client.get(QUESTION + start) for _ in range(3)))
            found += [one.json().get("verdict", one.status_code) for one in answers]
        jobs = await client.get("/jobs")
        return [*sorted(set(found)), jobs.status_code]
def tell(who, start):
    print(who, *asyncio.run(verdicts(start)), flush=True)
tell("parent", GO)
children = []
for start in (GO, NO_GO):
    child = os.fork()
    if child == 0:
        tell("child", start)
        app.state.services.close()
        os._exit(0)
    children.append(child)
tell("parent", NO_GO)
assert [os.waitpid(child, 0)[1] for child in children] == [0, 0]
tell("parent", GO)
app.state.services.close()
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
def test_an_application_that_has_answered_is_forked(tmp_path: Path) -> None:
    """The children asked the parent's helper process: one child got the verdict of the other's question."""
    command = [sys.executable, "-c", USED_THEN_FORKED, url_of(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S)
    told = sorted(done.stdout.splitlines())
    expected = ["child GO 200", "child NO_GO 200", "parent GO 200", "parent GO 200", "parent NO_GO 200"]
    assert told == expected, done.stderr[-3000:]


def test_an_application_in_two_threads_at_once_says_that_it_has_one_loop(
    tmp_path: Path, folder: Path
) -> None:
    """A second event loop made the first one wait for its deadline: 504."""
    app = app_of(tmp_path)
    try:
        with ThreadPoolExecutor(4) as threads:
            clients = [TestClient(app, base_url=BASE, client=("127.0.0.1", 1)) for _ in range(4)]
            assert asked(clients[0]).status_code == 200
            begun = time.monotonic()
            answers = [one for _ in range(4) for one in threads.map(asked, clients)]
        assert {one.status_code for one in answers} == {200, 503}
        refused = next(one for one in answers if one.status_code == 503)
        assert "event loop" in refused.json()["detail"]
        assert time.monotonic() - begun < PATIENCE_S / 2, "nobody waits for a deadline"
        assert asked(clients[1]).status_code == 200
        assert app.state.services.helpers.line._held.total() == 0
    finally:
        app.state.services.close()
