"""A user's script is checked by mypy --strict: every public name is typed, and a wrong use is found."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("users_script.py")


def checked(script: Path, cache: Path) -> tuple[int, str]:
    # In a folder without our configuration, as a user's is; the packages' own code is not his concern.
    command = [sys.executable, "-m", "mypy", "--strict", "--follow-imports=silent", "--cache-dir", str(cache)]
    done = subprocess.run(
        [*command, script.name],
        cwd=script.parent,
        capture_output=True,
        text=True,
        env=os.environ | {"MYPY_CONFIG_FILE_DIR": ""},
        check=False,
    )
    return done.returncode, done.stdout + done.stderr


@pytest.mark.slow
def test_a_users_script_is_typed(tmp_path):
    right, wrong = tmp_path / "users_script.py", tmp_path / "wrong.py"
    right.write_text(SCRIPT.read_text())
    wrong.write_text(
        "import safestart as ss\n"
        "s = ss.Scenario.of(3.0, 0.1)\n"
        "ss.decide(s, (5.0, 40.0), question='leave')\n"
        "n: int = ss.decide(s, (5.0, 40.0)).margin_m\n"
        "ss.nothing()\n"
    )
    assert checked(right, tmp_path / "cache") == (0, "Success: no issues found in 1 source file\n")
    code, said = checked(wrong, tmp_path / "cache")
    assert code == 1
    assert [line.split(":")[1] for line in said.splitlines() if ": error:" in line] == ["3", "4", "5"]
