"""Where helper processes come from: one process that has loaded forks them, or each loads for itself."""

from __future__ import annotations

import multiprocessing
import os
import socket
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Protocol

from safestart_service.computing.helpers import nursery, serving
from safestart_service.computing.helpers.process import Helper, HelperEnded

FORKS = hasattr(os, "fork") and hasattr(socket, "send_fds")
FORK_S = 10.0
"""A process that has loaded forks in milliseconds; one that has not after this time hangs."""
SETTLE_S = 0.1


class Source(Protocol):
    """Where helpers come from."""

    def helper(self) -> Helper:
        """A new one, which has loaded what answers need; raises ``HelperEnded``."""

    def ready(self) -> bool:
        """Whether a new one would be there at once."""

    def close(self) -> None:
        """Make no more."""


class Process(Protocol):
    """What we need of a ``subprocess.Popen``."""

    def poll(self) -> int | None:
        """Its exit status; None while it lives."""

    def wait(self, timeout: float | None = None) -> int:
        """Its exit status, when it has ended; raises ``subprocess.TimeoutExpired``."""

    def kill(self) -> None:
        """End it, whatever it does."""


class Forked:
    """Helpers that one process forks after it has loaded.

    ``first``: such a process, and where to ask it for helpers. When it ends a new program takes its place.
    """

    def __init__(self, first: tuple[Process, socket.socket] | None = None) -> None:
        self._lock = threading.Lock()
        self._closed = self._loaded = False
        self._process: Process | None = None
        self._control: socket.socket | None = None
        if first is not None:
            self._process, self._control = first
        # Linux ends that process with the thread that started it, so this thread does nothing else.
        self._starter = ThreadPoolExecutor(1, "nursery")

    def helper(self) -> Helper:
        """A new one."""
        try:
            return self._helper()
        except HelperEnded:
            # A process that was killed a moment ago still takes what is sent to it; the second time it is gone.
            self._settle()
            return self._helper()

    def _helper(self) -> Helper:
        try:
            control, loaded = self._started()
            connection = _asked(control)
        except (OSError, RuntimeError) as error:  # no process, or no thread to start it
            raise HelperEnded from error
        try:
            found = Helper(connection, FORK_S if loaded else None)
        except TimeoutError as error:
            self._end_if(control)
            raise HelperEnded from error
        self._loaded = self._loaded or control is self._control
        return found

    def _settle(self) -> None:
        process = self._process
        if process is not None:
            with suppress(subprocess.TimeoutExpired):
                process.wait(SETTLE_S)

    def ready(self) -> bool:
        """Whether that process lives and has loaded."""
        return self._loaded and self._process is not None and self._process.poll() is None

    def _started(self) -> tuple[socket.socket, bool]:
        """Where to ask for helpers, and whether one has come from there."""
        with self._lock:
            if self._closed:
                raise HelperEnded
            if self._control is None or self._process is None or self._process.poll() is not None:
                self._end()
                if not sys.executable:  # embedded in another program
                    raise HelperEnded("no Python to start")
                self._control, theirs = socket.socketpair()
                # It finds the modules that we find, and no others in the folder where we happen to run.
                environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, sys.path))}
                command = [sys.executable, "-P", "-m", nursery.__name__, str(theirs.fileno())]
                with theirs:
                    self._process = self._starter.submit(
                        subprocess.Popen,
                        command,
                        env=environment,
                        pass_fds=[theirs.fileno()],
                        stdin=subprocess.DEVNULL,
                        stdout=subprocess.DEVNULL,
                    ).result()
            return self._control, self._loaded

    def _end_if(self, control: socket.socket) -> None:
        """End the process behind ``control``, unless another one has taken its place."""
        with self._lock:
            if control is self._control:
                self._end()

    def close(self) -> None:
        """End the process that forks."""
        with self._lock:
            self._closed = True
            self._end()
        self._starter.shutdown(wait=False)

    def _end(self) -> None:
        if self._control is not None:
            self._control.close()
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._control = self._process = None
        self._loaded = False


def _asked(control: socket.socket) -> Connection:
    """Our end of the connection to a helper that is asked for."""
    ours, theirs = socket.socketpair()
    with theirs:
        connection = Connection(ours.detach())
        socket.send_fds(control, [b"+"], [theirs.fileno()])
    return connection


class Spawned:
    """Helpers that load for themselves, where a system cannot fork."""

    def helper(self) -> Helper:
        """A new one."""
        context = multiprocessing.get_context("spawn")
        try:
            ours, theirs = context.Pipe()
            with theirs:
                context.Process(target=_loaded, args=(theirs,), daemon=True).start()
        except OSError as error:
            raise HelperEnded from error
        return Helper(ours)

    def ready(self) -> bool:
        """Never: each loads for itself."""
        return False

    def close(self) -> None:
        """Nothing is left to end."""


def _loaded(connection: Connection) -> None:
    nursery.load()
    serving.serve(connection)
