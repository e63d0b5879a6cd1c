"""The service with a job in every state, and schemathesis asking it.

As a command, every operation by itself with many examples, which takes an hour or two; what passed is not run again:
``python -m tests.contract.fuzz.fuzzing FOLDER --examples 2000``
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import Any

import httpx

from safestart.processes.execute import execute
from safestart.processes.registry import PROCESS_IDS
from safestart.processes.tables import tables_of
from safestart.records.artifact import Artifact
from safestart.runtime.access import Caller, Role
from safestart.store.access.keys import KeyRepository
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.contract.api.service_client import url_of
from tests.waiting import PATIENCE_S

CONFIG = Path(__file__).with_name("schemathesis.toml")
BENCHMARK: dict[str, Any] = {
    "omega_t_deg_s": 3,
    "a_max_m_s2": 0.1,
    "grid": {"nx": 5, "ny": 5},
    "engines": ["analytical"],
}
SWEEP: dict[str, Any] = {"controllers": ["filter"], "omega_t_deg_s": [1, 4], "a_max_m_s2": [0.1]}
ROOMY = {
    "SAFESTART_ANSWER_TIMEOUT_S": str(PATIENCE_S),
    "SAFESTART_MAX_QUEUED": "1000000",
    "SAFESTART_RATE_PER_S": "1e9",
    "SAFESTART_SUBMIT_RATE_PER_S": "1e9",
}


@dataclass(frozen=True)
class Stock:
    """A database that was filled: its URL, an administrator's key, and by parameter the words that lead somewhere."""

    url: str
    key: str
    words: dict[str, list[str]]

    @property
    def secret(self) -> str:
        """The part of the key that nobody else may see."""
        return self.key.split("_", 2)[2]


def stock(folder: Path) -> Stock:
    """A job in every state, two of them successful, one running with a finished shard; an admin key and others."""
    url = url_of(folder)
    database = Database(url)
    database.migrate()
    jobs, keys = JobRepository(database), KeyRepository(database)
    by = Caller(None, "test", Role.ADMIN)
    _, key = keys.create("fuzz", Role.ADMIN, None, by)
    others = [keys.create(f"other {role}", role, 1.0, by)[0].id for role in Role]

    def started(process: str, inputs: dict[str, Any]) -> Any:
        jobs.submit(process, inputs, timeout_s=60.0)
        claim = jobs.claim("tester", 86400.0)
        assert claim is not None
        return claim

    ids = []
    done = execute("benchmark", BENCHMARK)
    for files in (done.artifacts, (Artifact("page.html", "text/html", b"<b>no</b>"),)):
        claim = started("benchmark", done.document["inputs"])
        jobs.progress(claim, 40.0, "analytical: row 2", 12.5)
        jobs.succeed(claim, done.document, files, {"safestart": "0"})
        ids.append(claim.job_id)
    claim = started("sweep", SWEEP)
    jobs.fail(claim, {"title": "Failed", "detail": "the machine burnt down"})
    ids.append(claim.job_id)
    claim = started("sweep", SWEEP)
    jobs.log(claim, "halfway")
    ids.append(claim.job_id)
    ids.append(jobs.dismiss(jobs.submit("sweep", SWEEP, timeout_s=60.0).id).id)
    ids.append(jobs.submit("benchmark", BENCHMARK, timeout_s=60.0).id)
    database.close()
    names = [file.name for file in done.artifacts] + ["page.html"]
    words = {
        "path.jobID": ids,
        "path.keyID": others,
        "path.name": names,
        "path.processID": list(PROCESS_IDS),
        "query.table": list(tables_of(done.document["outputs"])),
        "query.submitter": others,
    }
    return Stock(url, key, words)


@contextmanager
def served(found: Stock, log: Path) -> Iterator[str]:
    """The service on that database at its most talkative, without limits of rate, and patient; gives its address."""
    command = [sys.executable, "-m", "safestart_service", "--port", "0", "--database-url", found.url]
    with log.open("a") as sink:
        server = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=sink, text=True, env=os.environ | ROOMY
        )
    try:
        assert server.stdout is not None
        yield server.stdout.readline().split()[1]
    finally:
        server.terminate()
        server.wait(timeout=PATIENCE_S)


def ask(
    base: str, found: Stock, folder: Path, phases: str, examples: int, *only: str
) -> subprocess.CompletedProcess[str]:
    """Run schemathesis with all checks over the operations that ``only`` (its own options) selects."""
    config = folder / "schemathesis.toml"
    config.write_text(_bindings(found.words) + CONFIG.read_text())
    command = [
        *(sys.executable, "-m", "schemathesis.cli", "--config-file", str(config)),
        *("run", f"{base}/openapi.json", "--header", f"Authorization: Bearer {found.key}", "--checks", "all"),
        *("--phases", phases, "--max-examples", str(examples), "--continue-on-failure", "--no-shrink"),
        *("--suppress-health-check", "all", "--warnings", "off", "--request-timeout", str(PATIENCE_S), *only),
    ]
    hooks = {"SCHEMATHESIS_HOOKS": str(CONFIG.with_name("fuzz_profile.py"))}
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, env=os.environ | hooks)


def _bindings(words: dict[str, list[str]]) -> str:
    """Configuration that takes known words more often than random ones, and seldom waits for long."""
    found = {name: (json.dumps(values), 0.7) for name, values in words.items()}
    found["query.wait"] = ("[0, 0.01]", 0.98)
    lines = ["max-stream-events = 3"]
    # The key that is sent with every request counts; one invented beside it is not looked at.
    lines += ["[generation]", "with-security-parameters = false", "[dictionaries]"]
    lines += [f'"{name}" = {{ values = {values} }}' for name, (values, _) in found.items()]
    lines += ["[parameters]"]
    lines += [
        f'"{name}" = {{ dictionary = "{name}", probability = {often} }}' for name, (_, often) in found.items()
    ]
    return "\n".join([*lines, ""])


def main() -> None:
    """Every operation in turn; one line of JSON for each in ``FOLDER/done.jsonl``, what was said beside it."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--examples", type=int, default=2000)
    parser.add_argument("--phases", default="examples,coverage,fuzzing")
    parser.add_argument("--only", default="", help="operations whose name contains this")
    asked = parser.parse_args()
    folder: Path = asked.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    record = folder / "done.jsonl"
    lines = record.read_text().splitlines() if record.exists() else []
    passed = {line["operation"] for line in map(json.loads, lines) if line["passed"]}
    with TemporaryDirectory(dir=folder) as place:
        found = stock(Path(place))
        with served(found, folder / "service.log") as base:
            for name in operations(base):
                if asked.only in name and name not in passed:
                    started = monotonic()
                    ended = ask(base, found, folder, asked.phases, asked.examples, "--include-name", name)
                    (folder / (re.sub(r"\W+", "_", name) + ".txt")).write_text(ended.stdout + ended.stderr)
                    cases = re.search(r"(\d+) generated", ended.stdout)
                    line = {
                        "operation": name,
                        "passed": ended.returncode == 0,
                        "cases": int(cases[1]) if cases else 0,
                        "seconds": round(monotonic() - started, 1),
                    }
                    print(json.dumps(line), flush=True)
                    with record.open("a") as sink:
                        sink.write(json.dumps(line) + "\n")
    written = (folder / "service.log").read_text()
    print(f"tracebacks in the log: {written.count('Traceback')}, secrets: {written.count(found.secret)}")


def operations(base: str) -> list[str]:
    """All operations as schemathesis names them, those with the least to vary first."""
    found: dict[str, int] = {}
    for path, methods in httpx.get(f"{base}/openapi.json", timeout=60).json()["paths"].items():
        for method, operation in methods.items():
            found[f"{method.upper()} {path}"] = len(operation.get("parameters", ())) + 9 * (
                "requestBody" in operation
            )
    return sorted(found, key=found.__getitem__)


if __name__ == "__main__":
    main()
