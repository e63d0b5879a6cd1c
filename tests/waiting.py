"""Wait for other processes: for a condition, never for a fixed time, which a slow machine would exceed."""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import psutil

PATIENCE_S = 300.0
"""What takes longer is broken, however slow or loaded the machine is."""


def until(
    condition: Callable[[], Any], what: str, within_s: float = PATIENCE_S, log: Path | None = None
) -> Any:
    """Wait for a true answer and return it; without one fail, and show the end of ``log``."""
    deadline = time.monotonic() + within_s
    while not (answer := condition()):
        if time.monotonic() > deadline:
            said = "" if log is None else f"\n{log.read_text(errors='replace')[-4000:]}"
            raise AssertionError(f"waited {within_s:g} s for {what}{said}")
        time.sleep(0.02)
    return answer


def ended(pid: int) -> bool:
    """True when the process is gone. A zombie counts: who reaps it is not our matter."""
    try:
        return psutil.Process(pid).status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


def accepts(port: int) -> bool:
    """True when something listens on a port of this machine."""
    try:
        socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S).close()
    except OSError:
        return False
    return True


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
