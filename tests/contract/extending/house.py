"""A copy of the packages: adds a part as a person would, and counts the touched files and lines."""

from __future__ import annotations

import difflib
import filecmp
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[3]
HERE = Path(__file__).parent
PACKAGES = ("core/safestart", "service/safestart_service")
_NOT_SOURCE = shutil.ignore_patterns("__pycache__", "*.pyc", "*.nbi", "*.nbc")


class House:
    """The packages under ``root``."""

    def __init__(self, root: Path) -> None:
        self.root = root
        for package in PACKAGES:
            shutil.copytree(ROOT / package, root / package, ignore=_NOT_SOURCE)

    def add(self, example: str, place: str) -> None:
        """Put a file or a folder of this folder's into the packages."""
        source, target = HERE / example, self.root / place
        if source.is_dir():
            shutil.copytree(source, target, ignore=_NOT_SOURCE)
        else:
            shutil.copy(source, target)

    def add_line(self, file: str, after: str, line: str) -> None:
        """Write a line below the line that begins with ``after``."""
        path = self.root / file
        lines = path.read_text().splitlines(keepends=True)
        (place,) = [k for k, one in enumerate(lines) if one.strip().startswith(after)]
        lines.insert(place + 1, f"{line}\n")
        path.write_text("".join(lines))

    def touched(self) -> tuple[list[str], list[str]]:
        """New files and folders, and changed lines, each with a sign."""
        new: list[str] = []
        changed: list[str] = []
        for package in PACKAGES:
            self._compare(filecmp.dircmp(ROOT / package, self.root / package, ["__pycache__"]), new, changed)
        return new, changed

    def ask(self) -> dict[str, Any]:
        """The results of ``asked.py`` in the copy, in a separate process."""
        paths = [*(str(self.root / package.partition("/")[0]) for package in PACKAGES), str(ROOT)]
        done = subprocess.run(
            [sys.executable, "-m", "tests.contract.extending.asked", str(self.root)],
            cwd=ROOT,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        found: dict[str, Any] = json.loads(done.stdout)
        return found

    def _compare(self, found: filecmp.dircmp[str], new: list[str], changed: list[str]) -> None:
        assert not found.left_only
        new += [str(Path(found.right, name).relative_to(self.root)) for name in found.right_only]
        for name in found.diff_files:
            before, after = (Path(side, name).read_text().splitlines() for side in (found.left, found.right))
            lines = difflib.unified_diff(before, after, n=0, lineterm="")
            changed += [line for line in lines if line[0] in "+-" and not line.startswith(("+++", "---"))]
        for inner in found.subdirs.values():
            self._compare(inner, new, changed)
