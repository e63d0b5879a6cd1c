"""API keys over HTTP: ways to present one, and what becomes of those that are not in force."""

from __future__ import annotations

import asyncio
import json
import threading
from typing import Any

from safestart.runtime.access import Role
from safestart.store.access.keys import KeyRepository
from safestart.store.database import Database
from tests.contract.access.key_holders import BY, bearer
from tests.contract.api.service_client import assert_problem, service, url_of
from tests.contract.store.store_backends import pass_time
from tests.waiting import until


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
