"""A SQLite file that is moved, replaced or deleted while it is open: nothing is accepted into it or instead of it."""

from __future__ import annotations

import logging
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from safestart.errors import InvalidInput, Unavailable
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.contract.api.service_client import HEAVY, assert_problem, jobs_of, service, submit
from tests.contract.store.store_backends import ask
from tests.contract.store.store_jobs import submit as put

FILE = "service.sqlite3"
EXECUTION = "/processes/benchmark/execution"


def move(folder: Path, to: Path) -> None:
    """The database with the files beside it, as an operator moves it."""
    to.mkdir(exist_ok=True)
    for file in folder.glob(f"{FILE}*"):
        file.rename(to / file.name)


def test_a_service_without_its_file_takes_no_job_and_goes_on_when_it_is_back(tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    with service(tmp_path) as client:
        jobs_of(tmp_path).heartbeat("tester", 1, 0)
        first = submit(client)
        assert client.get("/readyz").status_code == 200
        move(tmp_path, elsewhere)
        for _ in range(2):
            assert_problem(client.post(EXECUTION, json=HEAVY), 503)
            assert_problem(client.get("/readyz"), 503)
            assert_problem(client.get("/jobs"), 503)
        assert not list(tmp_path.glob(f"{FILE}*")), "no empty database takes its place"
        move(elsewhere, tmp_path)
        assert client.get("/readyz").status_code == 200
        second = submit(client)
        listed = [job["jobID"] for job in client.get("/jobs").json()["jobs"]]
    assert {first, second} == set(listed)


def test_a_worker_without_its_file_claims_and_writes_nothing(tmp_path: Path) -> None:
    jobs = opened(tmp_path)
    put(jobs)
    claim = jobs.claim("worker", 60.0)
    assert claim is not None
    move(tmp_path, tmp_path / "elsewhere")
    with pytest.raises(Unavailable, match="its file was moved or deleted"):
        jobs.claim("worker", 60.0)
    with pytest.raises(Unavailable, match="its file was moved or deleted"):
        jobs.progress(claim, 50.0, "half", None)
    move(tmp_path / "elsewhere", tmp_path)
    jobs.progress(claim, 50.0, "half", None)


def test_it_is_said_once_when_the_file_goes_and_once_when_it_returns(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    jobs = opened(tmp_path)
    with caplog.at_level(logging.INFO, "safestart.store"):
        move(tmp_path, tmp_path / "elsewhere")
        for _ in range(3):
            with pytest.raises(Unavailable):
                jobs.counts()
        move(tmp_path / "elsewhere", tmp_path)
        jobs.counts()
        jobs.counts()
    gone, back = (record.getMessage() for record in caplog.records)
    assert "was moved, deleted or replaced" in gone
    assert "again" in back


@pytest.mark.parametrize("unfit", ["empty", "foreign", "new"])
def test_a_file_that_is_no_copy_does_not_take_its_place(tmp_path: Path, unfit: str) -> None:
    jobs = opened(tmp_path)
    move(tmp_path, tmp_path / "elsewhere")
    if unfit == "new":  # a worker that was started again meanwhile
        opened(tmp_path)._database.close()
    else:
        (tmp_path / FILE).write_bytes(b"" if unfit == "empty" else b"foreign " * 1000)
    for ask_it in (jobs.counts, lambda: put(jobs), jobs._database.migrate):
        with pytest.raises(Unavailable, match=r"another file is at its path|file is not a database"):
            ask_it()
    (tmp_path / FILE).unlink()
    move(tmp_path / "elsewhere", tmp_path)
    put(jobs)


def test_a_restored_copy_takes_its_place(tmp_path: Path) -> None:
    jobs = opened(tmp_path)
    job = put(jobs)
    jobs._database.close()  # so that the copy is whole
    move(tmp_path, tmp_path / "elsewhere")
    with pytest.raises(Unavailable):
        jobs.counts()
    shutil.copy(tmp_path / "elsewhere" / FILE, tmp_path / FILE)
    assert jobs.get(job.id).id == job.id
    put(jobs)


def test_only_a_migration_makes_the_file(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / FILE}")
    with pytest.raises(Unavailable, match="unable to open database file"):
        ask(database)
    assert not list(tmp_path.iterdir())
    database.migrate()
    ask(database)


def test_any_name_of_a_file_is_opened(tmp_path: Path) -> None:
    file = tmp_path / "a b%3F?#é.sqlite3"
    database = Database("sqlite:///x")
    database = Database(database._url.set(database=str(file)).render_as_string())
    database.migrate()
    put(JobRepository(database))
    database.close()
    assert [found.name for found in tmp_path.iterdir()] == [file.name]


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir])
def test_what_is_no_file_is_refused_at_once(tmp_path: Path, make: Callable[[Path], None]) -> None:
    """SQLite waits for ever for the other end of a pipe."""
    make(tmp_path / FILE)
    database = Database(f"sqlite:///{tmp_path / FILE}")
    with pytest.raises(Unavailable, match="regular file"):
        database.migrate()
    with pytest.raises(Unavailable, match="regular file"), database.session() as session:
        session.connection()


def test_a_database_that_is_away_is_named_in_the_log_alone(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with service(tmp_path) as client:
        move(tmp_path, tmp_path / "elsewhere")
        for answer in (client.get("/jobs"), client.post(EXECUTION, json=HEAVY), client.get("/readyz")):
            assert_problem(answer, 503)
            assert str(tmp_path) not in answer.text
            assert "log says why" in answer.text
    assert str(tmp_path) in caplog.text


def test_a_uri_is_refused() -> None:
    with pytest.raises(InvalidInput, match="a SQLite database by a URI"):
        Database("sqlite:///file:/tmp/x.sqlite3?mode=ro&uri=true")


def opened(folder: Path) -> JobRepository:
    database = Database(f"sqlite:///{folder / FILE}")
    database.migrate()
    return JobRepository(database)
