"""The program that loads what heavy answers need, once, and forks the helper processes.

A forked helper is there in milliseconds and shares what was loaded; one that loads for itself takes seconds.
``python -m safestart_service.computing.nursery FD``: the stream socket ``FD`` brings the end of a connection for each
new helper. When its other end is closed this program ends, and each helper ends with its own connection.
"""

from __future__ import annotations

import os
import signal
import socket
import sys
import traceback
import warnings
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any


def main(control: socket.socket) -> None:
    """Load, then fork a helper for every connection that comes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # at Ctrl-C the service ends its answers, and then us
    load()
    while True:
        _, ends, _, _ = socket.recv_fds(control, 1, 1)
        if not ends:
            return
        _bury()
        try:
            if _fork() == 0:
                control.close()
                serve(Connection(ends[0]))
                return
        except OSError:
            traceback.print_exc()  # the other end sees that its connection is closed
        os.close(ends[0])


def load() -> None:
    """Load what answers need. What fails here fails again in an answer, which says so."""
    from safestart_service.computing import inside

    try:
        inside.ready()
    except Exception:
        traceback.print_exc()


def serve(connection: Connection) -> None:
    """Say who this is, then do one call after the other until nobody can ask any more."""
    with suppress(EOFError, OSError), connection:
        connection.send(os.getpid())
        while True:
            function, arguments = connection.recv()
            connection.send(_done(function, arguments))


def _done(function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
    """Whether the call returned, and what it returned or raised."""
    try:
        return True, function(*arguments)
    except Exception as error:
        return False, error


def _bury() -> None:
    """Let go of helpers that have ended. Until then no other process gets the number of one."""
    with suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG) != (0, 0):
            pass


def _fork() -> int:
    with warnings.catch_warnings():
        # Python warns of the threads of OpenBLAS, which ends them before a fork and starts them again when needed.
        warnings.simplefilter("ignore", DeprecationWarning)
        return os.fork()


if __name__ == "__main__":
    main(socket.socket(fileno=int(sys.argv[1])))
