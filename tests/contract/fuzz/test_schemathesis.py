"""The whole API against its own description: schemathesis asks every operation, rightly and wrongly, with all checks.

With all phases and thousands of requests for each, by hand: :mod:`tests.contract.fuzz.fuzzing`.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.contract.fuzz.fuzzing import ask, served, stock

OPENAPI = Path(__file__).parents[3] / "openapi" / "openapi.json"
METHODS = {"get", "post", "put", "patch", "delete"}


@pytest.mark.timeout(1800)
def test_every_operation_keeps_its_word(tmp_path: Path) -> None:
    found = stock(tmp_path)
    log = tmp_path / "service.log"
    with served(found, log) as base:
        ended = ask(base, found, tmp_path, "examples,fuzzing", 10, "--seed", "1")
    assert ended.returncode == 0, ended.stdout[-20_000:] + ended.stderr[-2000:]
    assert f"Tested: {_operations()}" in ended.stdout
    assert "Traceback" not in log.read_text(), "nothing unexpected in the service's log"
    assert found.secret not in log.read_text()


def _operations() -> int:
    """How many operations the documentation has; their number and no smaller one is tested."""
    paths = json.loads(OPENAPI.read_text())["paths"]
    return sum(method in METHODS for path in paths.values() for method in path)
