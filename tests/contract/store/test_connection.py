"""A connection to PostgreSQL: a server that says nothing is left, and the session is ours whatever anybody has set."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic

import pytest
from sqlalchemy import make_url, text

from safestart.errors import Away, Unavailable
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.patient import PatientConnection
from tests.contract.store.store_backends import NO_SERVER, POSTGRESQL, ask, fresh_url
from tests.contract.store.store_jobs import submit

pytestmark = pytest.mark.skipif(not POSTGRESQL, reason=NO_SERVER)


class Frozen:
    """A server that passes everything on, until it stands still."""

    def __init__(self, host: str, port: int) -> None:
        self._to = host, port
        self.moves = threading.Event()
        self.moves.set()
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                near = self._listener.accept()[0]
                far = socket.create_connection(self._to)
                for one, other in ((near, far), (far, near)):
                    threading.Thread(target=self._pass, args=(one, other), daemon=True).start()

    def _pass(self, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):
            while data := one.recv(65536):
                self.moves.wait()
                other.sendall(data)
            other.shutdown(socket.SHUT_WR)

    def close(self) -> None:
        self._listener.close()


@contextmanager
def frozen_server(url: str) -> Iterator[tuple[Frozen, Database]]:
    parsed = make_url(url)
    server = Frozen(parsed.host or "127.0.0.1", parsed.port or 5432)
    near = parsed.set(host="127.0.0.1", port=server.port).render_as_string(hide_password=False)
    database = Database(near)
    try:
        yield server, database
    finally:
        server.moves.set()
        database.close()
        server.close()


def test_a_server_that_stands_still_is_left(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    with frozen_server(fresh_url("postgresql", tmp_path)) as (server, database):
        ask(database)
        monkeypatch.setattr(PatientConnection, "patience_s", 0.5)
        server.moves.clear()
        start = monotonic()
        with pytest.raises(Away, match=r"did not answer within 0\.5 s"):
            ask(database)
        assert monotonic() - start < 5.0
        server.moves.set()
        ask(database)  # on a new connection


def test_a_statement_that_takes_too_long_is_ended_by_the_server(tmp_path) -> None:
    database = Database(fresh_url("postgresql", tmp_path))
    try:
        with database.session() as session:
            limit = session.execute(text("SHOW statement_timeout")).scalar_one()
            assert limit not in ("0", "")
        with pytest.raises(Unavailable, match="statement timeout"):
            _sleep(database)
        database.migrate()
    finally:
        database.close()


def _sleep(database: Database) -> None:
    with database.session() as session:
        session.execute(text("SET LOCAL statement_timeout = 200"))
        session.execute(text("SELECT pg_sleep(5)"))


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
