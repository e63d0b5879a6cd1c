"""``safestart serve`` as a process: start, refusals, imports, live events; and the OpenAPI document."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import threading
from pathlib import Path

import httpx
import pytest
from openapi_spec_validator import validate

from tests.contract.api.service_client import HEAVY, POINT, finish, jobs_of
from tests.waiting import PATIENCE_S
from tools.openapi import FILE, render

SERVE = [sys.executable, "-m", "safestart_service"]


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """Base URL of a real server on a free port, and the queue behind it."""
    folder: Path = tmp_path_factory.mktemp("serve")
    url = f"sqlite:///{folder / 'service.sqlite3'}"
    process = subprocess.Popen(
        [*SERVE, "--port", "0", "--database-url", url], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    base = process.stdout.readline().split()[1]
    yield base, jobs_of(folder)
    process.terminate()
    process.wait(timeout=PATIENCE_S)


def test_live_events(server):
    """Events arrive while the job runs, and a broken stream goes on where it broke off."""
    base, jobs = server
    with httpx.Client(base_url=base, timeout=PATIENCE_S) as client:
        job = client.post("/processes/benchmark/execution", json=HEAVY).json()["jobID"]
        seen: list[str] = []
        with client.stream("GET", f"/jobs/{job}/events") as first:
            for line in first.iter_lines():
                seen += [line.removeprefix("id: ")] if line.startswith("id: ") else []
                if seen:
                    break  # the connection breaks off after the first event
        worker = threading.Timer(0.6, finish, args=(jobs,))
        worker.start()
        with client.stream("GET", f"/jobs/{job}/events", headers={"Last-Event-ID": seen[0]}) as second:
            lines = list(second.iter_lines())
        worker.join()
    ids = [line.removeprefix("id: ") for line in lines if line.startswith("id: ")]
    assert seen[0] not in ids
    data = [json.loads(line.removeprefix("data: ")) for line in lines if line.startswith("data: ")]
    assert [item["status"] for item in data if "status" in item] == ["running", "successful"]
    assert any(item.get("progress") == 40.0 for item in data)


def test_chunked_body_on_the_wire(server):
    base, _ = server

    def chunks():
        for _ in range(9):
            yield b" " * 1_000_000

    with httpx.Client(base_url=base, timeout=PATIENCE_S) as client:
        answer = client.post("/certificates", content=chunks(), headers={"Content-Type": "application/json"})
        assert answer.status_code == 413
        assert answer.headers["content-type"] == "application/problem+json"
        assert client.get("/go-no-go", params={**POINT, "x_m": 5, "y_m": 40}).json()["verdict"] == "GO"


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.1"])
def test_only_loopback_without_keys(host, tmp_path):
    where = ["--database-url", f"sqlite:///{tmp_path / 'empty.sqlite3'}"]
    ended = subprocess.run(
        [*SERVE, "--host", host, *where], capture_output=True, text=True, timeout=PATIENCE_S
    )
    assert ended.returncode == 2
    assert "loopback" in ended.stderr
    assert "safestart keys create" in ended.stderr
    assert len(ended.stderr.strip().splitlines()) == 1


def test_port_in_use():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        ended = subprocess.run([*SERVE, "--port", port], capture_output=True, text=True, timeout=PATIENCE_S)
    assert ended.returncode == 2
    assert port in ended.stderr
    assert len(ended.stderr.strip().splitlines()) == 1


def test_wrong_database():
    ended = subprocess.run(
        [*SERVE, "--port", "0", "--database-url", "oracle://x"],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert ended.returncode == 2
    assert "database_url" in ended.stderr


def test_the_service_loads_no_engine(tmp_path):
    """Neither the import nor the answers load the engines' packages; the import does not even load the store."""
    code = f"""
import sys
import safestart_service.app as app
heavy = {{"numba", "scipy", "matplotlib", "jax", "dask", "distributed", "hj_reachability", "safestart.engines.base"}}
assert not heavy & set(sys.modules), heavy & set(sys.modules)
assert "sqlalchemy" not in sys.modules
from tests.contract.api.service_client import HEAVY, POINT, service
from pathlib import Path
with service(Path({str(tmp_path)!r})) as client:
    assert client.get("/go-no-go", params={{**POINT, "x_m": 5, "y_m": 40}}).status_code == 200
    assert client.post("/certificates", json=POINT).status_code == 200
    assert client.post("/processes/benchmark/execution", json=HEAVY).status_code == 201
    assert client.get("/dashboard").status_code == 200
    assert client.get("/docs").status_code == 200
assert not heavy & set(sys.modules), heavy & set(sys.modules)
"""
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=PATIENCE_S)
    assert ended.returncode == 0, ended.stderr


def test_openapi_is_valid_and_has_not_drifted():
    text = render()
    document = json.loads(text)
    validate(document)
    assert FILE.read_text(encoding="utf-8") == text, "run `python tools/openapi.py write`"


def test_openapi_shows_processes_and_problems():
    document = json.loads(render())
    body = document["paths"]["/processes/{processID}/execution"]["post"]["requestBody"]["content"][
        "application/json"
    ]
    assert {"benchmark", "go-no-go", "certificate", "coverage"} <= set(body["examples"])
    assert "ExecuteBenchmark" in document["components"]["schemas"]
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            problems = [
                response
                for response in operation["responses"].values()
                if "problem+json" in json.dumps(response)
            ]
            assert problems, f"{method} {path} documents no problem"
