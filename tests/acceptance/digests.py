"""Do all answers stay what they were? ``python -m tests.acceptance.digests store|check [--only NAME ...] [--quick]``.

``digests.json`` holds, for each question and each place of its answer, a digest. ``check`` asks again and says which
place of which answer changed, ``store`` writes anew the digests of the questions it asks. With ``--keep FOLDER``
the answers themselves are written too: keep those of two trees, and ``diff -r`` shows the figures.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatch
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

from tests.acceptance.digested import questions

ROOT = Path(__file__).resolve().parents[2]
STORED = Path(__file__).with_name("digests.json")

SAME_ARITHMETIC = {
    # NumPy has other sines and exponentials, OpenBLAS other sums, for processors with AVX-512; the last bits differ,
    # and with them every solver's answer. These are what every x86-64 with AVX2 and FMA has. Numba needs nothing:
    # what it compiles for a Haswell and for a Sapphire Rapids gives the same bits.
    "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR",
    "OPENBLAS_CORETYPE": "Haswell",
    "XLA_FLAGS": "--xla_cpu_max_isa=AVX2",
    # A sum over two threads is another sum.
    "OPENBLAS_NUM_THREADS": "1",
    # What is read before it is written is absurd (1.4e306) instead of zero or the last call's, and so the same
    # everywhere, which no answer survives.
    "MALLOC_PERTURB_": "128",
}

Files = dict[str, dict[str, str]]
"""Digests by file and place."""


def answers(names: Sequence[str], keep: str = "") -> Iterator[dict[str, Any]]:
    """Ask in processes of their own, whose arithmetic is the same everywhere: an answer or an error of each."""
    served = [name for name in names if name.startswith("service/")]
    yield from _answers(
        "tests.acceptance.digested.runs", [name for name in names if name not in served], keep
    )
    yield from _answers("tests.acceptance.digested.service", served, keep)


def _answers(module: str, names: Sequence[str], keep: str) -> Iterator[dict[str, Any]]:
    if not names:
        return
    command = [sys.executable, "-m", module, keep, *names]
    environment = os.environ | SAME_ARITHMETIC | {"PYTHONPATH": str(ROOT)}
    with (
        TemporaryFile("w+") as said,
        subprocess.Popen(
            command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=said, text=True
        ) as child,
    ):
        assert child.stdout is not None
        for name in names:
            line, seconds = child.stdout.readline(), child.stdout.readline()
            if line.strip():
                answer = json.loads(line)
            else:
                said.seek(0)
                answer = {"error": f"the process died: {said.read()[-2000:]}"}
            yield {"name": name, "seconds": float(seconds or 0.0), **answer}


def differences(before: Mapping[str, Mapping[str, str]], now: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Which places of an answer changed, a line for each of its files."""
    lines = []
    for name in sorted(before.keys() | now.keys()):
        if name not in now or name not in before:
            lines.append(f"{name} {'is gone' if name in before else 'is new'}")
            continue
        old, new = before[name], now[name]
        changed = sorted(place for place in old.keys() | new.keys() if old.get(place) != new.get(place))
        if changed:
            places = [place for place in changed if not place.startswith("(")] or changed
            lines.append(f"{name} differs in {', '.join(places)}")
    return lines


def stored() -> dict[str, Files]:
    """The digests as they were; empty before the first ``store``."""
    return json.loads(STORED.read_text())["answers"] if STORED.exists() else {}


def arithmetic() -> dict[str, str]:
    """Versions of the computing packages and the processor, on which the last bits depend besides our code."""
    packages = (
        "numpy",
        "scipy",
        "numba",
        "llvmlite",
        "clarabel",
        "python-flint",
        "jax",
        "hj-reachability",
        "pyarrow",
    )
    found = {name: version(name) for name in packages if _installed(name)}
    # XLA compiles hj-reachability's single precision for the processor that it finds, whatever its flags say.
    return found | {"libc": " ".join(platform.libc_ver()), "processor": _processor()}


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.machine()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")


def _installed(name: str) -> bool:
    try:
        version(name)
    except PackageNotFoundError:
        return False
    return True


def other_arithmetic() -> str:
    """What computes here in another version than where the digests were stored, in words; empty: nothing."""
    made, here = json.loads(STORED.read_text())["made_with"], arithmetic()
    names = [name for name in made.keys() | here.keys() if made.get(name) != here.get(name)]
    return ", ".join(f"{name} {here.get(name)} instead of {made.get(name)}" for name in sorted(names))


def same_arithmetic_possible() -> bool:
    """Whether this machine can compute the same bits: x86-64 with AVX2 and FMA, and glibc's functions."""
    try:
        flags = Path("/proc/cpuinfo").read_text().split()
    except OSError:
        return False
    return (
        platform.machine() == "x86_64" and {"avx2", "fma"} <= set(flags) and platform.libc_ver()[0] == "glibc"
    )


def check(names: Sequence[str], keep: str = "") -> dict[str, list[str]]:
    """Differences by question, of those that have any; prints as it goes."""
    before, found = stored(), {}
    if other := other_arithmetic():
        print(f"computed here by {other}: differences may come from that")
    for answer in answers(names, keep):
        name = answer["name"]
        if "error" in answer:
            lines = [answer["error"]]
        elif name not in before:
            lines = ["no digests are stored"]
        else:
            lines = differences(before[name], answer["files"])
        print(f"{'differs' if lines else 'same':8}{answer['seconds']:7.1f} s  {name}", flush=True)
        for line in lines:
            print(f"    {line}")
        if lines:
            found[name] = lines
    return found


def store(names: Sequence[str], keep: str = "") -> list[str]:
    """Write the digests of these answers beside the others, each as it comes; returns the questions that have none."""
    found, failed, known = stored(), [], questions.names()
    for answer in answers(names, keep):
        print(f"{answer['seconds']:7.1f} s  {answer['name']}  {answer.get('error', '')}", flush=True)
        if "error" in answer:
            failed.append(answer["name"])
        else:
            found[answer["name"]] = answer["files"]
            _write({name: found[name] for name in sorted(found) if name in known})
    return failed


def _write(answers: Mapping[str, Files]) -> None:
    """One line per file of an answer, so that a change of the stored digests can be read."""
    blocks = []
    for name, files in answers.items():
        lines = [f"{json.dumps(file)}: {_line(files[file])}" for file in sorted(files)]
        blocks.append(f"{json.dumps(name)}: {{\n" + ",\n".join(lines) + "\n}")
    text = f'{{"made_with": {_line(arithmetic())},\n"answers": {{\n' + ",\n".join(blocks) + "\n}}\n"
    STORED.write_text(text)


def _line(document: Mapping[str, str]) -> str:
    return json.dumps(document, sort_keys=True, separators=(",", ":"))


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code 0: nothing differs."""
    parser = argparse.ArgumentParser(prog="python -m tests.acceptance.digests", description=__doc__)
    parser.add_argument("what", choices=("store", "check", "list"))
    parser.add_argument(
        "--only", nargs="+", metavar="NAME", help="questions, or patterns such as 'go-no-go/*'"
    )
    parser.add_argument("--quick", action="store_true", help="those that CI asks")
    parser.add_argument("--keep", default="", metavar="FOLDER", help="write the answers there")
    asked = parser.parse_args(arguments)
    names = questions.quick_names() if asked.quick else questions.names()
    if asked.only:
        names = [name for name in names if any(fnmatch(name, pattern) for pattern in asked.only)]
    if asked.what == "list":
        print("\n".join(names))
        return 0
    if asked.what == "store":
        return 1 if store(names, asked.keep) else 0
    found = check(names, asked.keep)
    print(f"{len(names) - len(found)} of {len(names)} answers are what they were")
    return 1 if found or not names else 0


if __name__ == "__main__":
    sys.exit(main())
