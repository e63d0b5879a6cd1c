"""A PostgreSQL server that takes everything and says nothing is noticed, and left."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from time import monotonic

import pytest
from sqlalchemy import make_url, text

from safestart.errors import Away, Unavailable
from safestart.store.database import Database
from safestart.store.patient import PatientConnection
from tests.contract.store.store_backends import NO_SERVER, POSTGRESQL, ask, fresh_url

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
