"""The program that forks helpers, forked itself from the service before that has threads or a database.

It shares what the service has loaded (pydantic, NumPy, SQLAlchemy, our models), which is a third of what it needs.
"""

from __future__ import annotations

import gc
import math
import multiprocessing
import os
import select
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterable
from time import monotonic, sleep

from safestart_service.computing.helpers import nursery
from safestart_service.computing.helpers.sources import Forked

_EVERY_S = 0.005
_UNKNOWN = -1


class Child:
    """A forked process, with those methods of ``subprocess.Popen`` that we need."""

    def __init__(self, control: socket.socket, others: Iterable[socket.socket]) -> None:
        context = multiprocessing.get_context("fork")
        self._process = context.Process(target=_run, args=(control, others), daemon=True)
        self._process.start()
        self._asking = threading.Lock()

    def poll(self) -> int | None:
        """Its exit status; None while it lives."""
        with self._asking:  # the system tells it once
            found = self._process.exitcode
        return _UNKNOWN if found is None and self._is_gone() else found

    def _is_gone(self) -> bool:
        """Whether the system has buried it and tells nobody, as it does for who ignores ``SIGCHLD``."""
        try:
            os.kill(self._process.pid or 0, 0)
        except ProcessLookupError:
            return True
        return False

    def wait(self, timeout: float | None = None) -> int:
        """Its exit status, when it has ended; raises ``subprocess.TimeoutExpired``."""
        until = math.inf if timeout is None else monotonic() + timeout
        while (found := self.poll()) is None:
            if monotonic() > until:
                raise subprocess.TimeoutExpired(nursery.__name__, timeout or 0.0)
            sleep(_EVERY_S)
        return found

    def kill(self) -> None:
        """End it, whatever it does."""
        self._process.kill()


def forked(others: Iterable[socket.socket]) -> Forked | None:
    """Helpers of a process that this one forks now, and which loads when the first helper is asked for.

    The child closes ``others``. None where a process with loaded libraries cannot be forked safely (elsewhere than on
    Linux, or beside threads, whose locks would stay taken in the child), or there is no room for one.
    """
    if not _alone():
        return None
    ours, theirs = socket.socketpair()
    # Pages whose objects nobody scans stay shared.
    gc.collect()
    gc.freeze()
    with theirs:
        try:
            child = Child(theirs, (ours, *others))
        except OSError:
            ours.close()
            return None
    return Forked((child, ours))


def _alone() -> bool:
    """Whether this process is known to have no other thread."""
    try:
        return sys.platform == "linux" and len(os.listdir("/proc/self/task")) == 1
    except OSError:  # a container may have no /proc
        return False


def _run(control: socket.socket, others: Iterable[socket.socket]) -> None:
    nursery.end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the service hears it, and then ends us
    for other in others:
        other.close()
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(nothing, 1)
    # While the service starts, it has the processor to itself.
    select.select([control], [], [])
    nursery.main(control)
