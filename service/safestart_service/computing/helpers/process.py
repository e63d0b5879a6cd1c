"""A helper process as the service sees it."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from time import monotonic
from typing import Any

from safestart_service.computing.helpers import serving

DYING_S = 1.0
"""A process that was killed takes calls until all its threads have ended, which takes longer beside others."""
KILL = getattr(signal, "SIGKILL", signal.SIGTERM)


class HelperEnded(Exception):
    """The process that did a call ended, or did not start."""


class NotBegun(HelperEnded):
    """The process ended, most likely before it began a call."""


class Helper:
    """A helper process at the other end of a connection.

    Raises ``HelperEnded`` where it did not start, and ``TimeoutError`` where it says nothing within ``within_s``.
    """

    def __init__(self, connection: Connection, within_s: float | None = None) -> None:
        self._connection = connection
        self._sending = threading.Lock()
        self.spent = False
        """Whether it has done its last call."""
        if not connection.poll(within_s):
            raise TimeoutError
        self._pid: int = self._received()

    def ask(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
        """Whether the call returned, and what it returned or raised; raises ``HelperEnded`` or ``NotBegun``."""
        begun = monotonic()
        try:
            with self._sending:
                self._connection.send((function, arguments))
            returned, answer, self.spent = self._received()
        except (OSError, HelperEnded) as error:
            raise NotBegun if monotonic() - begun < DYING_S else HelperEnded from error
        return returned, answer

    def _received(self) -> Any:
        try:
            return self._connection.recv()
        except (EOFError, OSError) as error:
            raise HelperEnded from error

    def ended(self) -> bool:
        """Whether the process is gone. An idle one sends nothing, so what there is to read is the end."""
        return self._connection.poll()

    def stop(self) -> None:
        """Tell it that nobody waits for its call any more; not where the call is still on its way."""
        if self._sending.acquire(blocking=False):
            with suppress(OSError):
                self._connection.send(serving.STOP)
            self._sending.release()

    def kill(self) -> None:
        """End the process, whatever it does; one that has just answered ends when its connection is dropped."""
        if not self.ended():
            with suppress(ProcessLookupError):
                os.kill(self._pid, KILL)
