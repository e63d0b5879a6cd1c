"""What a helper process does: one call after the other. While it computes it hears that nobody waits any more."""

from __future__ import annotations

import os
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import Any

STOP = None
"""What is sent instead of a call when nobody waits for the last one any more."""


class _Now:
    told = threading.Event()


def stopped() -> bool:
    """Whether nobody waits any more for the call that is being done."""
    return _Now.told.is_set()


def serve(connection: Connection) -> None:
    """Say who this is, then do calls; the process ends, whatever it does, when nobody can ask any more."""
    calls: SimpleQueue[tuple[threading.Event, Callable[..., Any], tuple[Any, ...]]] = SimpleQueue()
    threading.Thread(target=_listen, args=(connection, calls), daemon=True).start()
    with suppress(OSError), connection:
        connection.send(os.getpid())
        while True:
            _Now.told, function, arguments = calls.get()
            connection.send(_done(function, arguments))


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
