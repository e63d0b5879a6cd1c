"""What a helper process does: one call after the other. While it computes it hears that nobody waits any more."""

from __future__ import annotations

import math
import os
import re
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from queue import SimpleQueue
from typing import Any

STOP = None
"""What is sent instead of a call when nobody waits for the last one any more."""


class _Now:
    told = threading.Event()


def stopped() -> bool:
    """Whether nobody waits any more for the call that is being done."""
    return _Now.told.is_set()


def serve(connection: Connection, most_grown: float = math.inf) -> None:
    """Say who this is, then do calls; the process ends, whatever it does, when nobody can ask any more.

    With the answer goes whether this was the last one: calls have left more than ``most_grown`` bytes of memory behind.
    """
    calls: SimpleQueue[tuple[threading.Event, Callable[..., Any], tuple[Any, ...]]] = SimpleQueue()
    threading.Thread(target=_listen, args=(connection, calls), daemon=True).start()
    with suppress(OSError), connection:
        connection.send(os.getpid())
        most, last = _own_memory() + most_grown, False
        while not last:
            _Now.told, function, arguments = calls.get()
            answer = _done(function, arguments)
            del arguments
            last = _own_memory() > most
            connection.send((*answer, last))


def _own_memory() -> int:
    """Bytes that are not of files; 0 where the system does not tell."""
    try:
        status = Path("/proc/self/status").read_bytes()
    except OSError:
        return 0
    found = re.search(rb"^RssAnon:\s*(\d+) kB", status, re.MULTILINE)
    return 1024 * int(found[1]) if found else 0


def _listen(connection: Connection, calls: SimpleQueue[Any]) -> None:
    told = threading.Event()
    try:
        while True:
            message = connection.recv()
            if message is STOP:
                told.set()
            else:
                told = threading.Event()
                calls.put((told, *message))
            del message  # a body of megabytes
    except (EOFError, OSError):
        os._exit(0)
    except BaseException:
        traceback.print_exc()
        os._exit(1)


def _done(function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
    """Whether the call returned, and what it returned or raised."""
    try:
        return True, function(*arguments)
    except Exception as error:
        return False, error
