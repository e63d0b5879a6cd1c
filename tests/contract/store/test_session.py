"""A PostgreSQL session is ours, whatever the database, the role and the variables of a program say."""

from __future__ import annotations

from pathlib import Path

import pytest
from sqlalchemy import make_url, text

from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.contract.store.store_backends import NO_SERVER, POSTGRESQL, fresh_url
from tests.contract.store.store_jobs import submit

pytestmark = pytest.mark.skipif(not POSTGRESQL, reason=NO_SERVER)

OURS = {
    "datestyle": "ISO, MDY",
    "timezone": "UTC",
    "intervalstyle": "postgres",
    "client_encoding": "UTF8",
    "extra_float_digits": "1",
    "standard_conforming_strings": "on",
    "bytea_output": "hex",
    "default_transaction_isolation": "read committed",
    "enable_bitmapscan": "off",
}
THEIRS = {
    "datestyle": "German",
    "timezone": "Asia/Tokyo",
    "intervalstyle": "sql_standard",
    "client_encoding": "SQL_ASCII",
    "extra_float_digits": "-15",
    "standard_conforming_strings": "off",
    "bytea_output": "escape",
    "default_transaction_isolation": "serializable",
}


def of_database(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    database = Database(url)
    with database.session(write=True) as session:
        for name, value in THEIRS.items():
            session.execute(text(f"ALTER DATABASE {make_url(url).database} SET {name} = '{value}'"))
    database.close()


def of_options(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PGOPTIONS", " ".join(f"-c {name}={value}" for name, value in THEIRS.items()))
    monkeypatch.setenv("PGTARGETSESSIONATTRS", "bogus")


def of_variables(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in {"PGDATESTYLE": "German", "PGTZ": "Asia/Tokyo", "PGCLIENTENCODING": "LATIN1"}.items():
        monkeypatch.setenv(name, value)


@pytest.mark.parametrize("theirs", [of_database, of_options, of_variables])
def test_a_session_is_set_above_database_options_and_variables(
    theirs, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = fresh_url("postgresql", tmp_path)
    theirs(url, monkeypatch)
    database = Database(url)
    database.migrate()
    with database.session() as session:
        found = {name: session.execute(text(f"SHOW {name}")).scalar_one() for name in OURS}
        assert session.execute(text("SELECT 0.1::float8 + 0.2::float8")).scalar_one() == 0.1 + 0.2
    assert found == OURS
    jobs = JobRepository(database)
    job = submit(jobs)
    assert jobs.get(job.id).created_at == job.created_at
    database.close()


def test_what_the_url_says_of_a_session_is_obeyed(tmp_path: Path) -> None:
    url = fresh_url("postgresql", tmp_path)
    database = Database(url + "?application_name=mine&options=-csearch_path%3Delsewhere,public")
    with database.session() as session:
        found = [
            session.execute(text(f"SHOW {name}")).scalar_one() for name in ("application_name", "search_path")
        ]
    assert found == ["mine", "elsewhere,public"]
    database.close()
