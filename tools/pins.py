"""Exact versions without a lock file: ``pins.py write`` resolves anew, ``pins.py check`` fails on drift.

A lock file would hold download addresses. Instead ``[tool.uv] constraint-dependencies`` in the root pyproject.toml
holds the resolution, so that ``uv run`` on a fresh clone gives the same versions everywhere.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROJECT = ROOT / "pyproject.toml"
BEGIN, END = "# pins: begin (written by tools/pins.py)", "# pins: end"


def resolved() -> list[str]:
    """Every third-party requirement of the workspace as ``name==version ; marker``, sorted."""
    export = ["uv", "export", "--quiet", "--all-packages", "--all-groups", "--all-extras"]
    export += ["--no-hashes", "--no-emit-workspace", "--no-header", "--no-annotate"]
    text = subprocess.run(export, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return sorted(line.strip() for line in text.splitlines() if re.match(r"[a-z0-9]", line))


def pinned(text: str) -> list[str]:
    """The requirements in pyproject.toml now."""
    block = text.split(BEGIN, 1)[1].split(END, 1)[0]
    return sorted(re.findall(r'^\s+"(.+)",$', block, flags=re.MULTILINE))


def with_pins(text: str, pins: list[str]) -> str:
    """The project file with another block of pins."""
    before, rest = text.split(BEGIN, 1)
    after = rest.split(END, 1)[1]
    lines = "".join(f'    "{pin}",\n' for pin in pins)
    return f"{before}{BEGIN}\nconstraint-dependencies = [\n{lines}]\n{END}{after}"


def write() -> int:
    """Resolve the newest fitting versions without pins, and write them."""
    text = PROJECT.read_text()
    PROJECT.write_text(with_pins(text, []))
    try:
        subprocess.run(["uv", "lock", "--quiet", "--upgrade"], cwd=ROOT, check=True)
        pins = resolved()
    except subprocess.CalledProcessError:
        PROJECT.write_text(text)
        raise
    PROJECT.write_text(with_pins(text, pins))
    print(f"{len(pins)} versions pinned")
    return 0


def check() -> int:
    """Fail when the resolution has an unpinned version or a needless pin."""
    subprocess.run(["uv", "lock", "--quiet"], cwd=ROOT, check=True)
    now, wanted = set(resolved()), set(pinned(PROJECT.read_text()))
    for line in sorted(now - wanted):
        print(f"not pinned: {line}")
    for line in sorted(wanted - now):
        print(f"pinned but not resolved: {line}")
    if now != wanted:
        print("run: just lock")
        return 1
    print(f"{len(now)} pins agree with the resolution")
    return 0


if __name__ == "__main__":
    sys.exit({"write": write, "check": check}[sys.argv[1]]())
