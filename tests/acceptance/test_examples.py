"""The scripts of examples/ run as they stand, each outside the checkout."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.acceptance.running import serving

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
ALONE = sorted(one.name for one in EXAMPLES.glob("*.py") if one.name != "remote.py")


def run(name: str, folder: Path, *arguments: str) -> str:
    command = [sys.executable, str(EXAMPLES / name), *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_every_example_is_listed():
    page = (EXAMPLES.parent / "docs/examples.md").read_text()
    assert all(f"(../examples/{name})" in page for name in [*ALONE, "remote.py"])


@pytest.mark.slow
@pytest.mark.parametrize("name", ALONE)
def test_the_example_runs(name, tmp_path):
    assert run(name, tmp_path).strip()


@pytest.mark.slow
def test_the_remote_example_runs(tmp_path):
    with serving(f"sqlite:///{tmp_path / 'service.sqlite3'}") as url:
        assert "GO" in run("remote.py", tmp_path, url)
