"""The cache by content key, and the answers that come from it: over every backend, over restarts, over damage."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import text

from safestart.processes.execute import execute
from safestart.processes.go_no_go import atlases
from safestart.proofs.single import check
from safestart.records.artifact import Artifact
from safestart.runtime.progress import Context
from safestart.store.cache import Cache
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.contract.api.service_client import assert_problem, jobs_of, service

POINT = {"omega_t_deg_s": 2.0, "a_max_m_s2": 0.05}
SLIVER = {"x_m": 9.364, "y_m": 81.044}


@pytest.fixture
def forgetful() -> Iterator[None]:
    """A process that has no atlas in memory, as after a restart."""
    atlases._kept.clear()
    yield
    atlases._kept.clear()


def test_keeps_replaces_and_forgets_the_oldest(database: Database) -> None:
    cache = Cache(database, most_bytes=250)
    assert cache.find("a") is None
    cache.keep("a", b"1" * 100)
    cache.keep("a", b"2" * 100)
    assert cache.find("a") == b"2" * 100
    cache.keep("b", b"3" * 100)
    cache.keep("c", b"4" * 100)
    assert cache.find("a") is None
    assert cache.find("b") == b"3" * 100
    cache.keep("d", b"5" * 251)
    assert cache.find("d") is None
    assert cache.find("c") == b"4" * 100


def test_damaged_bytes_are_not_found(database: Database) -> None:
    cache = Cache(database)
    cache.keep("a", b"sound")
    with database.session(write=True) as session:
        session.execute(text("UPDATE cache SET data = :data"), {"data": b"forged"})
    assert cache.find("a") is None


def test_a_database_that_is_away_finds_and_keeps_nothing(tmp_path: Path) -> None:
    cache = Cache(Database(f"sqlite:///{tmp_path / 'absent' / 'store.sqlite3'}"))
    cache.keep("a", b"1")
    assert cache.find("a") is None


def test_what_a_job_made_is_found_by_its_key(database: Database) -> None:
    jobs = JobRepository(database)
    jobs.submit("atlas", {}, instant=None, timeout_s=60.0)
    claim = jobs.claim("tester", 60.0)
    assert claim is not None
    jobs.succeed(claim, {"outputs": {}}, (Artifact("proofs.npz", "application/x-npz", b"atlas", "key"),), {})
    assert Cache(database).find("key") == b"atlas"


@pytest.mark.usefixtures("forgetful")
def test_the_atlas_of_a_job_answers_many_starts_and_no_single_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A single start is solved: its margin is the same number before and after somebody made an atlas."""
    many = {"states": [{"x_m": 0.5 * k - 100.0, "y_m": 110.0} for k in range(400)], "method": "auto"}
    with service(tmp_path) as client:
        before = client.get("/go-no-go", params=POINT | SLIVER).json()
        client.post("/processes/atlas/execution", json={"inputs": POINT | {"grid": {"nx": 3, "ny": 3}}})
        jobs = jobs_of(tmp_path)
        claim = jobs.claim("tester", 60.0)
        assert claim is not None
        done = execute("atlas", claim.inputs)
        jobs.succeed(claim, done.document, done.artifacts, {})

        monkeypatch.setattr(atlases, "pack", _refuse)
        found = client.post("/processes/go-no-go/execution", json={"inputs": POINT | many}).json()
        assert "atlas" in found["decided_by"]
        one = client.get("/go-no-go", params=POINT | SLIVER).json()
        assert (one["verdict"], one["margin_m"], one["reason"]) == (
            "NO_GO",
            before["margin_m"],
            before["reason"],
        )
        proof = client.get(one["proof_url"])
        assert proof.headers["content-disposition"] == 'attachment; filename="proof.json"'
        assert check(proof.json()).verdict == "NO_GO"


@pytest.mark.usefixtures("forgetful")
def test_an_atlas_built_for_many_starts_is_there_after_a_restart(database: Database) -> None:
    states = [{"x_m": 0.5 * k, "y_m": 40.0} for k in range(120)]
    asked = POINT | {"method": "auto", "states": states}
    context = Context(shelf=Cache(database))
    first = _verdicts(asked, context)
    atlases._kept.clear()
    original, atlases.pack = atlases.pack, _refuse  # type: ignore[assignment]
    try:
        assert _verdicts(asked, context) == first
    finally:
        atlases.pack = original
    with database.session(write=True) as session:
        session.execute(text("UPDATE cache SET data = :data"), {"data": b"not an atlas"})
    atlases._kept.clear()
    assert _verdicts(asked, context) == first


def test_links_to_proofs(tmp_path: Path) -> None:
    with service(tmp_path) as client:
        query = POINT | SLIVER | {"method": "exact"}
        one = client.get("/go-no-go", params=query).json()
        assert check(client.get(one["proof_url"]).json()).verdict == "NO_GO"
        for method in ("paper", "closed_form"):
            asked = POINT | SLIVER | {"method": method}
            assert client.get("/go-no-go", params=asked).json().get("proof_url") is None
        # The closed form has no proof of its own: the link gives the exact one.
        assert check(client.get("/go-no-go/proof", params=POINT | SLIVER).json()).verdict == "NO_GO"
        assert_problem(client.get("/go-no-go/proof", params=query | {"x_m": "far"}), 422, "x_m")


def _verdicts(asked: dict[str, object], context: Context) -> list[str]:
    found: list[str] = execute("go-no-go", asked, context).document["outputs"]["verdict"]
    return found


def _refuse(*_: object) -> bytes:
    raise AssertionError("built anew although the shelf has it")
