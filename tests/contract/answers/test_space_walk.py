"""The walk of docs/theory/space.md: its commands, as printed there, give the same answer with a proof that verifies."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.proofs.checker import check
from tests.contract.api.service_client import service

PAGE = Path(__file__).parents[3] / "docs" / "theory" / "space.md"


def test_command_line_and_http_say_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    walk = PAGE.read_text().partition("## Walk")[2].partition("\n## ")[0]
    (shell, http) = re.findall(r"```sh\n(.*?)```", walk, re.DOTALL)
    body = re.search(r"<<'JSON'\n(.*?)\nJSON\n", shell, re.DOTALL)
    assert body is not None
    commands = [line.split()[1:] for line in shell.splitlines() if line.startswith("safestart ")]
    assert [one[0] for one in commands] == ["go-no-go", "verify"]
    assert "/go-no-go" in http
    monkeypatch.chdir(tmp_path)
    Path("envisat.json").write_text(body[1])
    for command in commands:
        done = CliRunner().invoke(build(), command)
        assert done.exit_code == 0, done.output
        assert "GO" in done.stdout
    proof = json.loads(Path("proof.json").read_text())
    assert check(proof).verdict == "GO"
    with service(tmp_path) as client:
        found = client.post("/go-no-go", json=json.loads(body[1]) | {"proofs": True}).json()
    assert found["verdict"] == ["GO"]
    assert found["margin_m"] == pytest.approx([proof["margin_m"]], abs=1e-6)
    assert found["proof"] == [proof]
