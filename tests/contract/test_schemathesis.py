"""The whole API against its own description: schemathesis asks every operation, rightly and wrongly, with all checks.

By hand, with all phases and more requests (hours): ``SAFESTART_FUZZ_EXAMPLES=2000`` and
``SAFESTART_FUZZ_PHASES=examples,coverage,fuzzing`` in the environment.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from safestart.access import Caller, Role
from safestart.store.database import Database
from safestart.store.keys import KeyRepository
from tests.contract.service_client import finish, jobs_of, url_of

CONFIG = Path(__file__).with_name("schemathesis.toml")
EXAMPLES = os.environ.get("SAFESTART_FUZZ_EXAMPLES", "10")
PHASES = os.environ.get("SAFESTART_FUZZ_PHASES", "examples,fuzzing")


@pytest.mark.timeout(7200)
def test_every_operation_keeps_its_word(tmp_path: Path) -> None:
    url = url_of(tmp_path)
    database = Database(url)
    database.migrate()
    _, key = KeyRepository(database).create("fuzz", Role.ADMIN, None, Caller(None, "test", Role.ADMIN))
    jobs = jobs_of(tmp_path)
    jobs.submit("benchmark", {"a": 1}, timeout_s=60.0)
    finish(jobs)
    log = tmp_path / "service.log"
    serve = [sys.executable, "-m", "safestart_service", "--port", "0", "--database-url", url]
    roomy = {
        "SAFESTART_MAX_QUEUED": "1000000",
        "SAFESTART_RATE_PER_S": "1e9",
        "SAFESTART_SUBMIT_RATE_PER_S": "1e9",
    }
    with log.open("w") as sink:
        server = subprocess.Popen(
            serve, stdout=subprocess.PIPE, stderr=sink, text=True, env=os.environ | roomy
        )
    try:
        assert server.stdout is not None
        base = server.stdout.readline().split()[1]
        command = [
            *(sys.executable, "-m", "schemathesis.cli", "--config-file", str(CONFIG)),
            *("run", f"{base}/openapi.json", "--header", f"Authorization: Bearer {key}", "--checks", "all"),
            *("--phases", PHASES, "--max-examples", EXAMPLES, "--continue-on-failure", "--no-shrink"),
            *("--suppress-health-check", "all", "--warnings", "off", "--request-timeout", "60"),
        ]
        ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    finally:
        server.terminate()
        server.wait(timeout=30)
    assert ended.returncode == 0, ended.stdout[-20_000:] + ended.stderr[-2000:]
    assert "Tested: " in ended.stdout
    assert "Traceback" not in log.read_text(), "nothing unexpected in the service's log"
    assert key.split("_", 2)[2] not in log.read_text()
