"""No key leaks from a real server, and beyond this machine none is needed less."""

from __future__ import annotations

import os
import subprocess
import sys

import httpx

from safestart.runtime.access import Role
from safestart.store.access.keys import KeyRepository
from safestart.store.database import Database
from tests.contract.access.key_holders import BY, KEY_FORM, bearer
from tests.contract.api.service_client import HEAVY, url_of
from tests.waiting import PATIENCE_S, free_port, until


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
    assert KEY_FORM.fullmatch(key), made.stderr
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
