"""A process that a benchmark starts, in a group of its own: its helpers end with it, however the benchmark ends.

The service's helper processes ignore SIGTERM and would compute on for minutes after the service. SIGTERM, which ends
Python on the spot, becomes an exception while such a process runs, so that ``timeout`` ends everything, too.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

GRACE_S = 30.0


@contextmanager
def own_group(command: Sequence[str], **options: Any) -> Iterator[subprocess.Popen[bytes]]:
    """The running command; on leaving it is asked to end, and what is left of its group is killed."""
    with _terminate_raises() as terminate:
        process = subprocess.Popen(command, start_new_session=True, **options)
        try:
            terminate.held = False
            terminate.obey()
            yield process
        finally:
            try:
                process.terminate()
                with suppress(subprocess.TimeoutExpired):
                    process.wait(GRACE_S)
            finally:  # a second signal ends the patience, not this
                with suppress(
                    ProcessLookupError, PermissionError
                ):  # nobody is left (macOS raises the second)
                    os.killpg(process.pid, signal.SIGKILL)
                process.wait()


class _Terminate:
    """The handler of SIGTERM. Held while a process starts: an exception then would lose the process."""

    def __init__(self) -> None:
        self.held = True
        self._came = False

    def __call__(self, *_: object) -> None:
        self._came = True
        if not self.held:
            self.obey()

    def obey(self) -> None:
        """Raise ``SystemExit`` if the signal has come."""
        if self._came:
            sys.exit(128 + signal.SIGTERM)


@contextmanager
def _terminate_raises() -> Iterator[_Terminate]:
    """SIGTERM is ours for a while, and of the group around this one afterwards; threads cannot handle signals."""
    terminate = _Terminate()
    if threading.current_thread() is not threading.main_thread():
        yield terminate
        return
    before = signal.signal(signal.SIGTERM, terminate)
    try:
        yield terminate
    finally:
        signal.signal(signal.SIGTERM, before)
