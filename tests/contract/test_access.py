"""API keys over HTTP: roles, expiry, revocation, rates, audit; nothing that tells keys apart, no secret anywhere."""

from __future__ import annotations

import base64
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path
from time import perf_counter_ns
from typing import Any

import httpx
import pytest
from typer.testing import CliRunner

from safestart.access import KEY_PATTERN, LOCAL, Caller, Role, key_digest
from safestart.cli import build
from safestart.errors import InvalidInput, NotFound
from safestart.store.audit import AuditLog
from safestart.store.database import Database
from safestart.store.keys import KeyRepository
from safestart_service import rates
from safestart_service.access import MOST_FAILURES_PER_S, needed_role
from safestart_service.keyring import Keyring
from safestart_service.rates import Buckets
from tests.contract.service_client import HEAVY, POINT, assert_problem, jobs_of, service, submit, url_of
from tests.contract.store_backends import BACKENDS, fresh_url, pass_time
from tests.waiting import PATIENCE_S, free_port, until

BY = Caller(None, "test", Role.ADMIN)
ASK = {**POINT, "x_m": 5, "y_m": 40}


@pytest.fixture(params=BACKENDS)
def database(request: pytest.FixtureRequest, tmp_path: Path):
    database = Database(fresh_url(request.param, tmp_path))
    database.migrate()
    yield database
    database.close()


@pytest.fixture
def keys(database: Database) -> KeyRepository:
    return KeyRepository(database)


@pytest.fixture
def guarded(tmp_path: Path):
    """A client, keys of every role, and the repository beside it."""
    with service(tmp_path) as client:
        found = client.app.state.services
        made = {role.value: found.keys.create(role.value, role, 1.0, BY)[1] for role in Role}
        found.keyring.load()
        yield client, made, found


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


# The store


def test_keys_are_random_and_only_digests_are_kept(keys):
    made = [keys.create(f"key {i}", Role.READ, None, BY) for i in range(50)]
    secrets = {key.rpartition("_")[2] if key.count("_") == 2 else key for _, key in made}
    assert len(secrets) == 50
    for record, key in made:
        match = KEY_PATTERN.fullmatch(key)
        assert match is not None
        assert match[1] == record.id
        assert len(base64.urlsafe_b64decode(key.split("_", 2)[2] + "=")) == 32, "256 bits"
        assert key not in repr(record)
    kept = {record.id: digest for record, digest in keys.digests()}
    assert kept == {record.id: key_digest(key.encode()) for record, key in made}


def test_expiry_and_revocation_are_the_databases_word(database, keys):
    short, _ = keys.create("short", Role.READ, 1.0, BY)
    lasting, _ = keys.create("lasting", Role.SUBMIT, None, BY)
    assert [key.usable for key in keys.list()] == [True, True]
    pass_time(database, 86401.0)
    assert {key.id: key.usable for key in keys.list()} == {short.id: False, lasting.id: True}
    assert keys.revoke(lasting.id, BY).revoked_at is not None
    first = keys.revoke(lasting.id, BY).revoked_at
    assert keys.revoke(lasting.id, BY).revoked_at == first, "revoking again changes nothing"
    assert not any(key.usable for key in keys.list())
    with pytest.raises(NotFound):
        keys.revoke("000000000000", BY)
    for name, days in (
        ("", 1),
        ("x" * 101, 1),
        ("a\nb", 1),
        ("x", 0),
        ("x", -1),
        ("x", 1e9),
        ("x", float("nan")),
    ):
        with pytest.raises(InvalidInput):
            keys.create(name, Role.READ, days, BY)


# Who may what


def test_without_keys_loopback_is_open(tmp_path):
    with service(tmp_path) as client:
        assert client.get("/go-no-go", params=ASK).status_code == 200
        assert client.get("/go-no-go", params=ASK, headers=bearer("anything")).status_code == 200
        submit(client)
        problem = assert_problem(client.get("/admin/keys"), 401)
        assert "safestart keys create" in problem["detail"]
        assert_problem(client.post("/admin/keys", json={"name": "x", "role": "admin"}), 401)


def test_without_keys_other_addresses_are_refused(tmp_path):
    """Even if something else than ``safestart serve`` binds the application to the network."""
    from starlette.testclient import TestClient

    with service(tmp_path) as client:
        outside = TestClient(client.app, base_url="http://192.0.2.7:8000")
        assert outside.get("/healthz").status_code == 200
        assert_problem(outside.get("/go-no-go", params=ASK), 401)
        assert_problem(outside.post("/processes/benchmark/execution", json=HEAVY), 401)


def test_roles(guarded):
    client, made, _ = guarded
    execution, light = "/processes/benchmark/execution", "/processes/certificate/execution"
    calls = [
        ("read", client.get, "/go-no-go", {"params": ASK}),
        ("read", client.post, "/certificates", {"json": POINT}),
        ("read", client.get, "/jobs", {}),
        ("read", client.get, "/metrics", {}),
        ("submit", client.post, execution, {"json": HEAVY}),
        ("read", client.post, light, {"json": {"inputs": POINT}}),
        ("submit", client.post, light, {"json": {"inputs": POINT}, "headers": {"Prefer": "respond-async"}}),
        ("admin", client.get, "/admin/keys", {}),
        ("admin", client.post, "/admin/keys", {"json": {"name": "new"}}),
        ("admin", client.get, "/admin/audit", {}),
    ]
    ranks = list(Role)
    for needed, call, path, more in calls:
        assert_problem(call(path, **more), 401)
        for role, key in made.items():
            answer = call(path, **{**more, "headers": {**more.get("headers", {}), **bearer(key)}})
            if ranks.index(Role(role)) >= ranks.index(Role(needed)):
                assert answer.status_code in (200, 201), (path, role, answer.text)
            else:
                assert_problem(answer, 403)


def test_every_operation_is_guarded_as_it_says(guarded):
    """No route without a rule: whatever is not public answers 401, and every change is refused to a read key."""
    client, made, _ = guarded
    document = client.app.openapi()
    for path, operations in document["paths"].items():
        concrete = path.replace("{", "").replace("}", "")
        for method, operation in operations.items():
            role = needed_role(method.upper(), concrete)
            assert bool(operation["security"]) == (role is not None)
            assert role is not None or method == "get", "what is public changes nothing"
            bare = client.request(method, concrete, follow_redirects=False)
            assert (bare.status_code == 401) == (role is not None), (method, path)
            if role is not None:
                assert bare.headers["www-authenticate"].startswith("Bearer")
            if role in (Role.SUBMIT, Role.ADMIN):
                assert_problem(client.request(method, concrete, headers=bearer(made["read"])), 403)
            if role is Role.ADMIN:
                assert_problem(client.request(method, concrete, headers=bearer(made["submit"])), 403)
    assert_problem(client.get("/nothing"), 401)
    assert_problem(client.put("/jobs/x"), 401)


@pytest.mark.parametrize("root", ["/behind", "/admin"])
def test_a_mount_path_hides_no_rule(guarded, root):
    from starlette.testclient import TestClient

    client, made, _ = guarded
    mounted = TestClient(client.app, root_path=root)
    assert_problem(mounted.get(f"{root}/admin/keys", headers=bearer(made["submit"])), 403)
    assert_problem(mounted.get(f"{root}/jobs"), 401)
    assert mounted.get(f"{root}/jobs", headers=bearer(made["read"])).status_code == 200


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


# Jobs know their submitter


def test_submitter_dismissal_and_audit(guarded):
    client, made, found = guarded
    other, key = found.keys.create("other", Role.SUBMIT, 1.0, BY)
    found.keyring.load()
    headers = {**bearer(made["submit"]), "X-Request-ID": "trace-9"}
    mine = client.post("/processes/benchmark/execution", json=HEAVY, headers=headers).json()
    ids = {record.name: record.id for record in found.keys.list()}
    assert mine["submitter"] == ids["submit"]
    path = f"/jobs/{mine['jobID']}"
    assert_problem(client.delete(path, headers=bearer(key)), 403, "jobID")
    assert_problem(client.delete(path, headers=bearer(made["read"])), 403)
    assert client.delete(path, headers=bearer(made["submit"])).json()["status"] == "dismissed"
    theirs = client.post("/processes/benchmark/execution", json=HEAVY, headers=bearer(key)).json()["jobID"]
    assert client.delete(f"/jobs/{theirs}", headers=bearer(made["admin"])).status_code == 200

    log = client.get("/admin/audit", headers=bearer(made["admin"])).json()["entries"]
    deeds = [(entry["action"], entry["subject"], entry["key_id"], entry["actor"]) for entry in log[:4]]
    assert deeds == [
        ("dismiss", theirs, ids["admin"], "admin"),
        ("submit", theirs, other.id, "other"),
        ("dismiss", mine["jobID"], ids["submit"], "submit"),
        ("submit", mine["jobID"], ids["submit"], "submit"),
    ]
    assert log[3]["request_id"] == "trace-9"
    assert log[3]["address"] == "testclient"
    about = client.get(f"/admin/audit?subject={theirs}&limit=1", headers=bearer(made["admin"])).json()
    assert [entry["action"] for entry in about["entries"]] == ["dismiss"]
    rest = client.get(
        f"/admin/audit?subject={theirs}&before={about['next_before']}", headers=bearer(made["admin"])
    )
    assert [entry["action"] for entry in rest.json()["entries"]] == ["submit"]


def test_refused_deeds_are_not_in_the_log(guarded):
    """The log says what was done: a repeated submission and a repeated dismissal did nothing."""
    client, made, found = guarded
    headers = {**bearer(made["submit"]), "Idempotency-Key": "k"}
    first = client.post("/processes/benchmark/execution", json=HEAVY, headers=headers).json()["jobID"]
    assert client.post("/processes/benchmark/execution", json=HEAVY, headers=headers).json()["jobID"] == first
    for _ in range(2):
        assert client.delete(f"/jobs/{first}", headers=headers).status_code == 200
    actions = [entry.action for entry in found.audit.entries(subject=first).entries]
    assert actions == ["dismiss", "submit"]


def test_only_an_admin_key_goes_ahead_of_others(guarded):
    client, made, found = guarded
    path = "/processes/benchmark/execution"

    def ask(role, priority):
        return client.post(path, json={**HEAVY, "priority": priority}, headers=bearer(made[role]))

    assert_problem(ask("submit", 1), 403, "priority")
    assert_problem(ask("submit", 101), 422, "priority")
    low, usual, high = (ask(*how).json() for how in (("submit", -5), ("submit", 0), ("admin", 5)))
    places = found.jobs.positions(job["jobID"] for job in (low, usual, high))
    assert [places[job["jobID"]] for job in (high, usual, low)] == [1, 2, 3]
    assert (low["priority"], high["priority"]) == (-5, 5)


def test_idempotency_keys_are_each_submitters_own(guarded):
    client, made, found = guarded
    key = found.keys.create("other", Role.SUBMIT, 1.0, BY)[1]
    found.keyring.load()
    made_jobs = {
        client.post(
            "/processes/benchmark/execution", json=HEAVY, headers={**bearer(who), "Idempotency-Key": "run-1"}
        ).json()["jobID"]
        for who in (made["submit"], key, made["submit"], key)
    }
    assert len(made_jobs) == 2


def test_submissions_without_keys_are_audited_too(tmp_path):
    with service(tmp_path) as client:
        job = submit(client)
        client.delete(f"/jobs/{job}")
        entries = client.app.state.services.audit.entries().entries
    assert [(entry.action, entry.key_id, entry.actor) for entry in entries] == [
        ("dismiss", None, LOCAL.name),
        ("submit", None, LOCAL.name),
    ]


# Rates


def test_rates_per_key(tmp_path, monkeypatch):
    monkeypatch.setattr("safestart_service.rates.monotonic", lambda: 0.0)
    with service(tmp_path, rate_per_s=0.5, submit_rate_per_s=0.2) as client:
        found = client.app.state.services
        one, two = (found.keys.create(name, Role.SUBMIT, None, BY)[1] for name in ("one", "two"))
        found.keyring.load()
        submitted = [
            client.post("/processes/benchmark/execution", json=HEAVY, headers=bearer(one)) for _ in range(3)
        ]
        assert [answer.status_code for answer in submitted] == [201, 201, 429]
        assert int(submitted[-1].headers["retry-after"]) > 0
        assert assert_problem(submitted[-1], 429)["type"].endswith("rate-limited")
        asked = [client.get("/go-no-go", params=ASK, headers=bearer(one)).status_code for _ in range(4)]
        assert asked == [200, 200, 429, 429]
        assert client.get("/go-no-go", params=ASK, headers=bearer(two)).status_code == 200
        assert client.get("/healthz").status_code == 200


def test_guessing_is_slowed_down_but_shuts_nobody_out(guarded, monkeypatch):
    """On a clock that stands still: a slow machine must not fill the bucket while it asks."""
    client, made, _ = guarded
    now = [0.0]
    monkeypatch.setattr(rates, "monotonic", lambda: now[0])

    def guess() -> int:
        return client.get("/jobs", headers=bearer("guess")).status_code

    burst = round(MOST_FAILURES_PER_S * rates.BURST_S)
    assert [guess() for _ in range(burst + 2)] == [401] * burst + [429] * 2
    assert client.get("/jobs", headers=bearer(made["read"])).status_code == 200
    now[0] = 1.0
    again = round(MOST_FAILURES_PER_S)
    assert [guess() for _ in range(again + 1)] == [401] * again + [429]


def test_buckets_fill_again_and_stay_few(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(rates, "monotonic", lambda: now[0])
    buckets = Buckets(2.0, burst=3.0)
    assert [buckets.take("a") for _ in range(4)] == [True, True, True, False]
    now[0] = 0.5
    assert [buckets.take("a") for _ in range(2)] == [True, False]
    now[0] = 100.0
    assert [buckets.take("a") for _ in range(4)] == [True, True, True, False]
    for i in range(rates.MOST_NAMES + 10):
        buckets.take(str(i))
    assert len(buckets._held) == rates.MOST_NAMES


# Nothing leaks


def test_checking_takes_the_same_time_whatever_is_presented(keys):
    """By construction one digest and one comparison; measured in turns, so that a drift of the machine meets all."""
    _, good = keys.create("good", Role.READ, None, BY)
    record, revoked = keys.create("revoked", Role.READ, None, BY)
    keys.revoke(record.id, BY)
    ring = Keyring(keys)
    ring.load()
    unknown = good.replace(good.split("_")[1], "0" * 12)
    near = good[:-1] + ("A" if good[-1] != "A" else "B")
    far = good.split("_", 2)
    texts = {
        "good": good,
        "revoked": revoked,
        "unknown": unknown,
        "near": near,
        "far": f"sst_{far[1]}_" + "x" * 43,
    }
    shown = {name: key.encode() for name, key in texts.items()}
    assert [name for name, key in shown.items() if ring.check(key)] == ["good"]
    times: dict[str, list[int]] = {name: [] for name in shown}
    for _ in range(4000):
        for name, key in shown.items():
            start = perf_counter_ns()
            ring.check(key)
            times[name].append(perf_counter_ns() - start)
    medians = {name: statistics.median(values) for name, values in times.items()}
    # A comparison that stops at the first difference of 64 characters would differ by less than this; what is
    # excluded here is a step left out, such as the digest or the look-up. The comparison is hmac's.
    assert max(medians.values()) < 1.5 * min(medians.values()), medians


def test_no_secret_in_logs_database_or_answers(tmp_path):
    """A server at its most talkative, keys presented in every way and place; only the first answer shows one."""
    url = url_of(tmp_path)
    database = Database(url)
    database.migrate()
    repository = KeyRepository(database)
    made = {role: repository.create(role.value, role, 1.0, BY)[1] for role in Role}
    database.close()
    port = free_port()
    code = (
        "import logging; logging.basicConfig(level=logging.DEBUG);"
        "import safestart_service.commands as c, uvicorn; config = uvicorn.Config;"
        "uvicorn.Config = lambda *a, **k: config(*a, **{**k, 'log_level': 'trace', 'access_log': True});"
        f"c._serve({{'port': {port}, 'database_url': {url!r}}})"
    )
    execution = "/processes/benchmark/execution"
    log = tmp_path / "log.txt"
    answers: list[str] = []
    with log.open("wb") as sink:
        process = subprocess.Popen([sys.executable, "-c", code], stdout=sink, stderr=sink, env={**os.environ})
    try:
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=PATIENCE_S) as client:
            until(lambda: _answers(client), "a service that answers")
            for key in made.values():
                wrong = key[:-4] + "AAAA"
                for shown in (key, wrong):
                    for headers in (bearer(shown), {"X-API-Key": shown}, {"Authorization": f"Basic {shown}"}):
                        answers += [client.get(path, headers=headers).text for path in ("/jobs", "/nothing")]
                        answers.append(client.post(execution, json=HEAVY, headers=headers).text)
                        answers.append(client.post(execution, content=b"{", headers=headers).text)
            fresh = client.post(
                "/admin/keys", json={"name": "fresh"}, headers=bearer(made[Role.ADMIN])
            ).json()["key"]
            answers.append(client.get("/admin/keys", headers=bearer(made[Role.ADMIN])).text)
            answers.append(client.get("/admin/audit", headers=bearer(made[Role.ADMIN])).text)
            answers.append(client.get("/jobs", headers=bearer(made[Role.READ])).text)
    finally:
        process.terminate()
        process.wait(PATIENCE_S)
    written = log.read_bytes()
    assert b"/jobs" in written, "the log is talkative"
    stored = b"".join(file.read_bytes() for file in tmp_path.glob("service.sqlite3*"))
    for key in (*made.values(), fresh):
        secret = key.split("_", 2)[2]
        assert key.split("_")[1].encode() in stored, "the id is there"
        assert secret[:20].encode() not in written
        assert secret[:20].encode() not in stored
        assert not any(secret[:20] in answer for answer in answers)


def _answers(client: httpx.Client) -> bool:
    try:
        return client.get("/healthz").status_code == 200
    except httpx.TransportError:
        return False


# Starting


def test_beyond_loopback_with_a_key(tmp_path):
    url = url_of(tmp_path)
    made = subprocess.run(
        [
            sys.executable,
            "-m",
            "safestart",
            "keys",
            "create",
            "--name",
            "ops",
            "--role",
            "admin",
            "--database-url",
            url,
        ],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    key = made.stdout.strip()
    assert KEY_PATTERN.fullmatch(key), made.stderr
    command = [
        sys.executable,
        "-m",
        "safestart_service",
        "--host",
        "0.0.0.0",
        "--port",
        "0",
        "--database-url",
        url,
    ]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        port = process.stdout.readline().split()[1].rpartition(":")[2]
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=PATIENCE_S) as client:
            assert client.get("/jobs").status_code == 401
            assert client.get("/jobs", headers=bearer(key)).status_code == 200
            assert client.get("/admin/keys", headers=bearer(key)).status_code == 200
    finally:
        process.terminate()
        _, errors = process.communicate(timeout=PATIENCE_S)
    assert "TLS" in errors
    assert key not in errors


def test_keys_on_the_command_line(tmp_path):
    where = ["--database-url", url_of(tmp_path)]

    app = build()

    def run(*arguments: str) -> Any:
        return CliRunner().invoke(app, ["keys", *arguments, *where])

    made = json.loads(run("create", "--name", "a [b]", "--role", "submit", "--days", "0", "--json").stdout)
    assert made["expires"] is None
    listed = run("list")
    assert "a [b]" in listed.stdout
    assert made["key"] not in run("list", "--json").stdout
    assert json.loads(run("revoke", made["id"], "--json").stdout)["usable"] is False
    entries = json.loads(run("audit", "--json").stdout)["entries"]
    assert [entry["action"] for entry in entries] == ["revoke-key", "create-key"]
    assert all(entry["actor"].startswith("cli") for entry in entries)
    assert "revoked" in run("list").stdout
    assert isinstance(run("revoke", "nope").exception, NotFound)
    assert AuditLog(Database(url_of(tmp_path))).entries(limit=1).next_before is not None
    assert jobs_of(tmp_path).counts()["accepted"] == 0
