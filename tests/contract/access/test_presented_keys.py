"""API keys over HTTP: ways to present one, and the refusal of those that are not in force."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
from sqlalchemy import update

from safestart.runtime.access import Role
from safestart.store.access.keys import KeyRepository
from safestart.store.access.models import KeyRow
from safestart.store.database import Database
from safestart.store.dialect import after
from tests.contract.access.key_holders import BY, bearer
from tests.contract.api.service_client import HEAVY, assert_problem, service, url_of
from tests.contract.server.raw_http import small_server
from tests.contract.store.store_backends import pass_time
from tests.waiting import PATIENCE_S, until

SLACK_S = 1.0
"""For a machine that has much else to do; before, an ended key followed until the job had ended."""


def test_ways_to_present_a_key(guarded):
    client, made, _ = guarded
    key = made["read"]

    for headers in (bearer(key), {"authorization": f"bearer  {key}"}, {"X-API-Key": key}):
        assert client.get("/jobs", headers=headers).status_code == 200, headers
    wrong = [
        {},
        bearer(""),
        bearer(key[:-1]),
        bearer(key + "A"),
        bearer(key.upper()),
        {"Authorization": key},
        {"Authorization": "Basic %%%"},
        {"X-API-Key": b"\xe9" * 600},
        {"Authorization": "Digest x", "X-API-Key": key},  # the first one named counts, not the one that fits
    ]
    assert len({_told(client.get("/jobs", headers=headers)) for headers in wrong}) == 1


def _told(answer: Any) -> tuple[Any, ...]:
    """All that an answer tells, apart from the id of the request."""
    problem = assert_problem(answer, 401)
    problem.pop("request_id")
    return json.dumps(problem, sort_keys=True), answer.headers["www-authenticate"]


def test_ended_keys_are_refused_and_keys_stay_required(guarded):
    client, made, found = guarded
    _, key = found.keys.create("short", Role.ADMIN, 0.1, BY)
    found.keyring.load()
    assert client.get("/jobs", headers=bearer(key)).status_code == 200
    pass_time(found.database, 8641.0)
    found.keyring.load()
    expired = _told(client.get("/jobs", headers=bearer(key)))
    ids = {record.name: record.id for record in found.keys.list()}
    assert (
        client.delete(f"/admin/keys/{ids['read']}", headers=bearer(made["admin"])).json()["usable"] is False
    )
    assert _told(client.get("/jobs", headers=bearer(made["read"]))) == expired, "at once, in the same words"
    assert_problem(client.delete(f"/admin/keys/{ids['admin']}", headers=bearer(made["admin"])), 409, "keyID")
    for key_id in ids.values():
        found.keys.revoke(key_id, BY)
    found.keyring.load()
    assert _told(client.get("/jobs")) == expired, "without any key in force nothing opens"
    assert client.get("/healthz").status_code == 200


def test_keys_made_elsewhere_count_within_seconds(tmp_path):
    with service(tmp_path) as client:
        record, key = KeyRepository(Database(url_of(tmp_path))).create("x", Role.READ, None, BY)
        until(lambda: client.get("/jobs").status_code == 401, "the new key")
        assert client.get("/jobs", headers=bearer(key)).status_code == 200
        until(lambda: client.app.state.services.keys.list()[0].last_used_at is not None, "a note of its use")
        KeyRepository(Database(url_of(tmp_path))).revoke(record.id, BY)
        until(lambda: client.get("/jobs", headers=bearer(key)).status_code == 401, "its revocation")


def test_a_revocation_waits_for_no_computation(tmp_path):
    """Every thread that computes is busy for longer than anyone would wait."""
    with service(tmp_path) as client:
        repository = KeyRepository(Database(url_of(tmp_path)))
        record, key = repository.create("x", Role.READ, None, BY)
        until(lambda: client.get("/jobs", headers=bearer("")).status_code == 401, "the new key")
        release = threading.Event()

        async def occupy() -> None:
            for _ in range(64):
                asyncio.get_running_loop().run_in_executor(None, release.wait)

        client.portal.call(occupy)
        try:
            repository.revoke(record.id, BY)
            until(lambda: client.get("/metrics", headers=bearer(key)).status_code == 401, "its revocation")
        finally:
            release.set()


@pytest.mark.parametrize("how", ["elsewhere", "here", "expired"])
def test_an_ended_key_ends_what_it_follows(server, how):
    """Open event streams end within a second of it, long polls are answered; those of others go on."""
    base, database = server
    repository = KeyRepository(database)
    (record, key), (_, other) = (repository.create(name, Role.SUBMIT, 1.0, BY) for name in ("ends", "stays"))
    admin_key = repository.create("admin", Role.ADMIN, None, BY)[1]
    with httpx.Client(base_url=base, timeout=PATIENCE_S) as client, ThreadPoolExecutor() as pool:
        until(lambda: client.get("/jobs").status_code == 401, "the first key")
        until(lambda: client.get("/jobs", headers=bearer(admin_key)).status_code == 200, "the last key")
        job = client.post("/processes/benchmark/execution", json=HEAVY, headers=bearer(key)).json()["jobID"]
        staying = pool.submit(_ended, base, f"/jobs/{job}/events", other)
        ends = [
            pool.submit(_ended, base, path, key) for path in (f"/jobs/{job}/events", f"/jobs/{job}?wait=30")
        ]
        time.sleep(1.0)
        still = [end.done() for end in (staying, *ends)]
        began = time.time()
        if how == "elsewhere":
            repository.revoke(record.id, BY)
        elif how == "here":
            assert client.delete(f"/admin/keys/{record.id}", headers=bearer(admin_key)).status_code == 200
        else:
            _expire(database, record.id)
        until(lambda: all(end.done() for end in ends), "the end of what the key followed")
        still.append(staying.done())
        client.delete(f"/jobs/{job}", headers=bearer(admin_key))  # which ends the stream that goes on
        found = [end.result() for end in ends]
        assert [status for status, _ in found] == [200, 401]
        assert max(at for _, at in found) - began < 1.0 + SLACK_S, found
        assert not any(still)
        assert staying.result()[0] == 200


def test_the_first_key_ends_what_was_followed_without(server_without_keys):
    base, database = server_without_keys
    with ThreadPoolExecutor() as pool:
        job = httpx.post(f"{base}/processes/benchmark/execution", json=HEAVY).json()["jobID"]
        end = pool.submit(_ended, base, f"/jobs/{job}/events", None)
        time.sleep(1.0)
        assert not end.done()
        began = time.time()
        KeyRepository(database).create("first", Role.READ, None, BY)
        until(end.done, "the end of the stream")
        assert end.result()[1] - began < 1.0 + SLACK_S


def _ended(base: str, path: str, key: str | None) -> tuple[int, float]:
    """Status of an answer, and when it had come to its end."""
    answer = httpx.get(base + path, headers=bearer(key) if key else {}, timeout=PATIENCE_S)
    return answer.status_code, time.time()


def _expire(database: Database, key_id: str) -> None:
    with database.session(write=True) as session:
        session.execute(update(KeyRow).where(KeyRow.id == key_id).values(expires_at=after(-1.0)))


@pytest.fixture
def server(tmp_path):
    """A real server whose first key was made already, and its database."""
    with _served(tmp_path) as (base, database):
        KeyRepository(database).create("first", Role.READ, None, BY)
        yield base, database


@pytest.fixture
def server_without_keys(tmp_path):
    with _served(tmp_path) as found:
        yield found


@contextmanager
def _served(folder):
    with small_server(folder, streams=8) as (host, port):
        yield f"http://{host}:{port}", Database(url_of(folder))


def test_made_over_http(guarded):
    client, made, _ = guarded
    admin = bearer(made["admin"])
    answer = client.post("/admin/keys", json={"name": "ops", "role": "submit", "days": 2}, headers=admin)
    assert answer.status_code == 201
    assert answer.headers["cache-control"] == "no-store"
    assert client.get("/jobs", headers=bearer(answer.json()["key"])).status_code == 200
    listed = client.get("/admin/keys", headers=admin)
    assert answer.json()["key"] not in listed.text
    assert [key["name"] for key in listed.json()["keys"]][-1] == "ops"
    for body in (
        {},
        {"name": ""},
        {"name": "x", "role": "root"},
        {"name": "x", "days": -1},
        {"name": "x", "more": 1},
    ):
        assert_problem(client.post("/admin/keys", json=body, headers=admin), 422)
    assert_problem(client.delete("/admin/keys/none", headers=admin), 404, "keyID")
