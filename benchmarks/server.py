"""A uvicorn server beside a benchmark, and the wait for its answers."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.error import HTTPError

from benchmarks.own_group import own_group

ROOT = Path(__file__).resolve().parents[1]
START_LIMIT_S = 600.0
"""What takes longer is broken, however busy the machine is."""


@contextmanager
def server(target: str, probe: str, **environment: str) -> Iterator[int]:
    """A uvicorn process on a free loopback port that answers ``probe``; ended on leaving, with its helpers."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    options = ["--loop", "uvloop", "--http", "httptools", "--no-access-log", "--log-level", "warning"]
    options += ["--factory"] if target.endswith(":create_app") else []
    command = [sys.executable, "-m", "uvicorn", target, "--port", str(port), *options]
    with own_group(command, cwd=ROOT, env={**os.environ, **environment}) as process:
        answered(port, probe, process=process)
        yield port


def answered(
    port: int, path: str, process: subprocess.Popen[bytes] | None = None, within_s: float = START_LIMIT_S
) -> None:
    """Ask until the answer is 200. A refusal (503 while a helper process starts) is asked again, a mistake is not.

    Raises ``RuntimeError`` with the last refusal after ``within_s``, or when ``process`` has ended.
    """
    deadline, last = time.monotonic() + within_s, "no answer"
    while (left := deadline - time.monotonic()) > 0.0:
        if process is not None and process.poll() is not None:
            raise RuntimeError(f"the server on port {port} ended with exit code {process.returncode}")
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", timeout=left):
                return
        except OSError as error:  # refusals and timeouts are among them
            last = str(error)
            if isinstance(error, HTTPError) and error.code < 500 and error.code != 429:
                break
            time.sleep(0.05)
    raise RuntimeError(f"port {port}: required an answer to {path} within {within_s:g} s, received: {last}")
