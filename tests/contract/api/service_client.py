"""A client of the service on a database of its own, and jobs in every state."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from safestart.records.artifact import Artifact
from safestart.runtime.settings import Settings
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.waiting import PATIENCE_S

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # the test client announces a successor of httpx
    from starlette.testclient import TestClient

BASE = "http://127.0.0.1"
POINT = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}
HEAVY = {"inputs": {**POINT, "grid": {"nx": 5, "ny": 5}, "engines": ["analytical"]}}
SMALL: dict[str, Any] = {
    **POINT,
    "grid": {"nx": 9, "ny": 9, "y_max_m": 150},
    "engines": ["analytical", "exact"],
}
PNG = b"\x89PNG\r\n\x1a\n" + bytes(40)


@contextmanager
def service(folder: Path, **settings: Any) -> Iterator[TestClient]:
    """A client on this machine whose unexpected server errors are answers, as they are on the wire.

    It waits for answers as long as our tests do: what is answered is asked here, not how soon a loaded machine does it.
    """
    from safestart_service.app import create_app

    chosen = Settings(database_url=url_of(folder), **{"answer_timeout_s": PATIENCE_S, **settings})
    here: dict[str, Any] = {"base_url": BASE, "client": ("127.0.0.1", 50_000)}
    with TestClient(create_app(chosen), raise_server_exceptions=False, **here) as client:
        yield client


def url_of(folder: Path) -> str:
    """URL of the database behind :func:`service`."""
    return f"sqlite:///{folder / 'service.sqlite3'}"


def jobs_of(folder: Path) -> JobRepository:
    """The same store, as a worker sees it."""
    return JobRepository(Database(url_of(folder)))


def submit(client: TestClient, **headers: str) -> str:
    """Queue a small benchmark; returns its id."""
    answer = client.post("/processes/benchmark/execution", json=HEAVY, headers=headers)
    assert answer.status_code == 201, answer.text
    job: str = answer.json()["jobID"]
    return job


def finish(jobs: JobRepository, *, progress: bool = True) -> None:
    """Claim the next job and end it with a small result and two artifacts."""
    claim = jobs.claim("tester", 60.0)
    assert claim is not None
    if progress:
        jobs.progress(claim, 40.0, "exact: row 2", 12.5)
        jobs.log(claim, "halfway")
    document = {
        "inputs": claim.inputs,
        "outputs": {
            "rows": [{"engine": "analytical", "area_m2": 12.5}],
            "notes": ["<script>alert(1)</script>"],
        },
        "provenance": {"seed": 0},
    }
    artifacts = (Artifact("map.png", "image/png", PNG), Artifact("page.html", "text/html", b"<b>no</b>"))
    jobs.succeed(claim, document, artifacts, {"safestart": "0"})


def digest(data: bytes) -> str:
    """Hex SHA-256."""
    return hashlib.sha256(data).hexdigest()


def assert_problem(answer: Any, status: int, field: str | None = None) -> dict[str, Any]:
    """The answer is a complete RFC 9457 document of this status, and names this field."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem: dict[str, Any] = answer.json()
    assert set(problem) >= {"type", "title", "status", "detail", "instance", "field", "required", "received"}
    assert problem["status"] == status
    assert "Traceback" not in answer.text
    if field is not None:
        assert field in str(problem["field"]), problem
        assert problem["required"] is not None
    return problem
