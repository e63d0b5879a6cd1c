"""Helper processes that do one call at a time each. A call that is cancelled ends its process."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any, Protocol, TypeVar

from safestart_service.computing import nursery

Answer = TypeVar("Answer")
FORKS = hasattr(os, "fork") and hasattr(socket, "send_fds")


class HelperEnded(Exception):
    """The process that did a call ended, or did not start."""


class Helper:
    """A helper process at the other end of a connection; raises ``HelperEnded`` where it did not start."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._pid: int = self._received()

    def ask(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
        """Whether the call returned, and what it returned or raised; raises ``HelperEnded``."""
        try:
            self._connection.send((function, arguments))
        except OSError as error:
            raise HelperEnded from error
        found: tuple[bool, Any] = self._received()
        return found

    def _received(self) -> Any:
        try:
            return self._connection.recv()
        except (EOFError, OSError) as error:
            raise HelperEnded from error

    def ended(self) -> bool:
        """Whether the process is gone. An idle one sends nothing, so what there is to read is the end."""
        return self._connection.poll()

    def kill(self) -> None:
        """End the process, whatever it does; one that has just answered ends when its connection is dropped."""
        if not self.ended():
            with suppress(ProcessLookupError):
                os.kill(self._pid, signal.SIGKILL if FORKS else signal.SIGTERM)


class Source(Protocol):
    """Where helpers come from."""

    def helper(self) -> Helper:
        """A new one, which has loaded what answers need; raises ``HelperEnded``."""

    def close(self) -> None:
        """Make no more."""


class Forked:
    """Helpers that one process forks after it has loaded."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._closed = False
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None

    def helper(self) -> Helper:
        """A new one."""
        ours, theirs = socket.socketpair()
        with theirs:
            try:
                socket.send_fds(self._started(), [b"+"], [theirs.fileno()])
            except OSError as error:
                ours.close()
                raise HelperEnded from error
        return Helper(Connection(ours.detach()))

    def _started(self) -> socket.socket:
        with self._lock:
            if self._closed:
                raise HelperEnded
            if self._control is None or self._process is None or self._process.poll() is not None:
                self._end()
                self._control, theirs = socket.socketpair()
                # It finds the modules that we find, and no others in the folder where we happen to run.
                environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, sys.path))}
                command = [sys.executable, "-P", "-m", nursery.__name__, str(theirs.fileno())]
                with theirs:
                    self._process = subprocess.Popen(
                        command,
                        env=environment,
                        pass_fds=[theirs.fileno()],
                        stdin=subprocess.DEVNULL,
                        stdout=subprocess.DEVNULL,
                    )
            return self._control

    def close(self) -> None:
        """End the process that forks."""
        with self._lock:
            self._closed = True
            self._end()

    def _end(self) -> None:
        if self._control is not None:
            self._control.close()
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._control = self._process = None


class Spawned:
    """Helpers that load for themselves, where a system cannot fork."""

    def helper(self) -> Helper:
        """A new one."""
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        with theirs:
            context.Process(target=_loaded, args=(theirs,), daemon=True).start()
        return Helper(ours)

    def close(self) -> None:
        """Nothing is left to end."""


def _loaded(connection: Connection) -> None:
    nursery.load()
    nursery.serve(connection)


class Pool:
    """At most ``most`` calls at once; a helper is kept when its call is done."""

    def __init__(self, most: int, source: Source | None = None) -> None:
        self._source = source or (Forked() if FORKS else Spawned())
        self._threads = ThreadPoolExecutor(most + 1, "helper")  # one more starts the first helper
        self._idle: list[Helper] = []
        self._busy: set[Helper] = set()

    async def start(self) -> None:
        """Have a helper that waits for a call; raises ``HelperEnded``."""
        helper = await self._helper()
        self._idle.append(helper)

    async def __call__(self, function: Callable[..., Answer], *arguments: Any) -> Answer:
        """``function(*arguments)`` in a helper; raises what it raises, and ``HelperEnded``."""
        helper = await self._helper()
        self._busy.add(helper)
        try:
            returned, answer = await self._in_thread(helper.ask, function, arguments)
            self._idle.append(helper)
        except asyncio.CancelledError:
            helper.kill()
            raise
        finally:
            self._busy.discard(helper)
        if not returned:
            raise answer
        found: Answer = answer
        return found

    async def _helper(self) -> Helper:
        while self._idle:
            helper = self._idle.pop()
            if not helper.ended():
                return helper
        return await self._in_thread(self._source.helper)

    async def _in_thread(self, work: Callable[..., Answer], *arguments: Any) -> Answer:
        future = asyncio.get_running_loop().run_in_executor(self._threads, work, *arguments)
        # Cancelled, nobody waits for its end any more, and nobody needs to know how it ended.
        future.add_done_callback(lambda done: None if done.cancelled() else done.exception())
        return await asyncio.shield(future)

    def close(self) -> None:
        """End all processes, and with them the threads that wait for one."""
        self._source.close()
        for helper in (*self._idle, *self._busy):
            helper.kill()
        self._idle.clear()
        self._threads.shutdown(wait=False, cancel_futures=True)
