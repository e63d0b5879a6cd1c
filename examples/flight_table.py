"""Verdicts aboard: the tables of two operating points, compiled and asked where there is a C compiler."""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    command = [sys.executable, "-m", "safestart", "export-c", "--output", name, "--precision", "float32"]
    subprocess.run([*command, "--omega-t-deg-s", "1,3", "--a-max-m-s2", "0.1"], check=True)
    subprocess.run([*command[:6], "--check"], check=True)
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        print("no C compiler on this machine")
    else:
        sources = [str(file) for file in sorted(folder.glob("*.c"))]
        subprocess.run(
            [compiler, "-std=c99", "-O2", *sources, "-lm", "-o", str(folder / "selftest")], check=True
        )
        subprocess.run([str(folder / "selftest")], check=True)
