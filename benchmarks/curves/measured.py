"""Time and memory of one size, each in a process of its own: ``python -m benchmarks.curves.measured NAME SIZE``."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.asked import parser
from benchmarks.curves.works import CURVES

ENOUGH_S = 1.0
MOST_RUNS = 7
_ROOT = Path(__file__).resolve().parents[2]


def points(name: str) -> Iterator[dict[str, Any]]:
    """``amount``, ``seconds`` and ``mib`` of each parameter of a curve."""
    for parameter in CURVES[name].parameters:
        command = [sys.executable, "-m", "benchmarks.curves.measured", name, str(parameter)]
        done = subprocess.run(command, cwd=_ROOT, check=True, capture_output=True, text=True)
        yield json.loads(done.stdout.splitlines()[-1])


def measure(name: str, parameter: int) -> dict[str, Any]:
    """Processor seconds of this process (median) and the most memory, MiB, that the work took beyond what was there.

    The smallest parameter comes first: it loads and compiles.
    """
    curve = CURVES[name]
    curve.prepare(curve.parameters[0])()
    work = curve.prepare(parameter)
    before = _forget_peak()
    taken = [_seconds(work)]
    mib = _kib("VmHWM") / 1024 - before
    while sum(taken) < ENOUGH_S and len(taken) < MOST_RUNS:
        taken.append(_seconds(curve.prepare(parameter) if name == "jobs" else work))
    return {"amount": curve.amount(parameter), "seconds": median(taken), "mib": max(mib, 0.0)}


def _seconds(work: Any) -> float:
    begun = time.process_time()
    work()
    return time.process_time() - begun


def _forget_peak() -> float:
    """Let the kernel count the peak anew; the memory in use now, MiB."""
    Path("/proc/self/clear_refs").write_text("5")
    return _kib("VmRSS") / 1024


def _kib(field: str) -> float:
    status = Path("/proc/self/status").read_text()
    return float(status.split(f"{field}:")[1].split()[0])


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("name")
    asked.add_argument("parameter", type=int)
    given = asked.parse_args()
    print(json.dumps(measure(given.name, given.parameter)))
