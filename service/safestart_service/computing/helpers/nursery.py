"""The program that loads what heavy answers need, once, and forks the helper processes.

A forked helper is there in milliseconds and shares what was loaded; one that loads for itself takes seconds.
``python -m safestart_service.computing.helpers.nursery FD``: the stream socket ``FD`` brings the end of a connection
for each new helper. When its other end is closed this program ends, also while it loads, and each helper ends with its
own connection.
"""

from __future__ import annotations

import ctypes
import os
import select
import signal
import socket
import sys
import threading
import traceback
import warnings
from contextlib import suppress
from multiprocessing.connection import Connection

from safestart_service.computing.allocator import MEGABYTE, keep_little
from safestart_service.computing.helpers.serving import serve

MOST_GROWN = 16 * 1024**2
"""Bytes. A helper that has kept more for itself is dearer than the milliseconds of a new one."""
_PR_SET_PDEATHSIG = 1


def main(control: socket.socket) -> None:
    """Load, then fork a helper for every connection that comes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # at Ctrl-C the service ends its answers, and then us
    end_with_parent()
    keep_little(MEGABYTE)
    try:
        threading.Thread(target=_end_without, args=(control,), daemon=True).start()
    except RuntimeError as error:  # the account may have no more threads
        _say(error)
        return
    loaded = load()
    # One end at a time: a helper that was forked with the end of another one would keep that connection open, and
    # nobody would see that the other one has ended.
    while (end := _received(control)) is not None:
        loaded = loaded or load()
        _bury()
        try:
            if _fork() == 0:
                end_with_parent()
                control.close()
                serve(Connection(end), MOST_GROWN)
                return
        except OSError as error:
            _say(error)  # the other end sees that its connection is closed
        os.close(end)


def _received(control: socket.socket) -> int | None:
    """The next end of a connection; None when the other end of ``control`` is closed."""
    try:
        _, found, _, _ = socket.recv_fds(control, 1, 1)
    except OSError:
        return None
    return found[0] if found else None


def _end_without(control: socket.socket) -> None:
    """Without a service the process ends, whatever it does."""
    watched = select.poll()
    watched.register(control, getattr(select, "POLLRDHUP", 0))  # elsewhere a hang-up is told unasked
    watched.poll()
    os._exit(0)


def load() -> bool:
    """Load what answers need. What fails here fails again in an answer, which says so; the next call tries again."""
    # Modules look for files beside them; from a folder that was deleted some of them cannot be loaded.
    try:
        os.getcwd()
    except OSError:
        os.chdir(os.path.abspath(os.sep))
    from safestart_service.computing import inside

    try:
        inside.ready()
    except Exception:
        traceback.print_exc()
        return False
    return True


def end_with_parent() -> None:
    """Have Linux end this process with the one that started it, also while a library keeps the interpreter to itself.

    OpenBLAS does that for ever where it gets no memory to load into. Without a connection our threads end us, too.
    """
    with suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _say(error: Exception) -> None:
    with suppress(OSError, ValueError, AttributeError):  # nobody may listen
        print(f"safestart: no helper process for heavy answers: {error}", file=sys.stderr, flush=True)


def _bury() -> None:
    """Let go of helpers that have ended. Until then no other process gets the number of one."""
    with suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG) != (0, 0):
            pass


def _fork() -> int:
    with warnings.catch_warnings():
        # Python warns of other threads: those of OpenBLAS, which ends them before a fork and starts them again when
        # needed, and ours, which waits for a connection and holds nothing that a helper needs.
        warnings.simplefilter("ignore", DeprecationWarning)
        return os.fork()


if __name__ == "__main__":
    main(socket.socket(fileno=int(sys.argv[1])))
