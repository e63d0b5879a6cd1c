"""How long a user waits: ``safestart serve`` from start to its first answer, and a command-line verdict."""

from __future__ import annotations

import os
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

from benchmarks.own_group import own_group
from benchmarks.timing import once

RUNS = 3
LIMIT_S = 60.0
QUESTION = "/go-no-go?omega_t_deg_s=3&a_max_m_s2=0.1&x_m=5&y_m=40"
VERDICT = ["go-no-go", "--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--x-m", "5", "--y-m", "40", "--json"]


def measure() -> dict[str, dict[str, float]]:
    """Medians over fresh databases and fresh processes."""
    command = [sys.executable, "-m", "safestart", *VERDICT]
    verdict = [
        once(lambda: subprocess.run(command, check=True, stdout=subprocess.DEVNULL)) for _ in range(RUNS)
    ]
    served = [_first_answer() for _ in range(RUNS)]
    return {
        "ratios": {},
        "times": {
            "serve_first_answer_s": statistics.median(served),
            "cli_go_no_go_s": statistics.median(verdict),
        },
    }


def _first_answer() -> float:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with tempfile.TemporaryDirectory() as folder:
        url = f"sqlite:///{Path(folder) / 'start.sqlite3'}"
        start = time.perf_counter()
        command = [sys.executable, "-m", "safestart", "serve", "--port", str(port)]
        environment = os.environ | {"SAFESTART_DATABASE_URL": url}
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        with own_group(command, env=environment, **quiet):
            while time.perf_counter() - start < LIMIT_S:
                try:
                    with urllib.request.urlopen(
                        f"http://127.0.0.1:{port}{QUESTION}", timeout=LIMIT_S
                    ) as answer:
                        answer.read()
                    return time.perf_counter() - start
                except urllib.error.URLError:
                    time.sleep(0.01)
            raise TimeoutError(f"no answer within {LIMIT_S:g} s")
