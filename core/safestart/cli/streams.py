"""Standard streams whose write errors do not end a command.

The exit code of a command is part of its answer: a rejected proof is rejected even when nobody reads the reason. A
failed write therefore raises nothing during the work. The command reports a full disk at its end in one sentence, and
says nothing when the reader closed the pipe.
"""

from __future__ import annotations

import errno
import io
import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NoReturn, cast

from safestart.errors import InvalidInput
from safestart.runtime.own_process import exit_code, own_configuration

NOT_WRITTEN = 2
_READER_MS = 10_000
_WRITABLE = "backslashreplace"
r"""What an encoding lacks is written as ``\u65e5``: a terminal of another one must not end a command."""


class _Kept(io.FileIO):
    """A file that keeps its first write error and drops all later data."""

    failure: OSError | None = None

    def write(self, data: Any, /) -> int:
        """Write the data, or drop it after a failure."""
        if self.failure is None:
            try:
                return super().write(data) or 0
            except OSError as error:
                self.failure = error
        return memoryview(data).nbytes


class Streams:
    """The standard output and error of this process while a command runs."""

    def __init__(self, stdout: _Kept | None, closed: bool) -> None:
        self._stdout = stdout
        self._closed = closed

    def code(self, code: int) -> int:
        """Flush the streams and return the exit code of a command that ended with ``code``."""
        _flush()
        reason = "it is closed" if self._closed and _written() else None
        failure = None if self._stdout is None else self._stdout.failure
        if (
            failure is not None and failure.errno != errno.EPIPE
        ):  # the reader (head, less) left: nothing is wrong
            reason = failure.strerror
        if reason is None:
            return code
        sys.stderr.write(f"safestart: standard output: required one that accepts output ({reason})\n")
        _flush()
        return code or NOT_WRITTEN


@contextmanager
def patient_streams() -> Iterator[Streams]:
    """Replace the real standard streams for the block; the streams of a test or a notebook stay."""
    closed = sys.stdout is None
    _occupy()
    before = sys.stdin, sys.stdout, sys.stderr
    if sys.stdin is None:
        sys.stdin = io.TextIOWrapper(io.BufferedReader(_Closed()))
    if closed:
        sys.stdout = io.TextIOWrapper(io.BufferedWriter(_Dropped(1)), "utf-8", _WRITABLE)
    if sys.stderr is None:
        sys.stderr = io.TextIOWrapper(io.BufferedWriter(_Dropped(2)), "utf-8", _WRITABLE)
    kept = None
    if sys.stdout is sys.__stdout__:
        kept, sys.stdout = _wrapped(cast(io.TextIOWrapper, sys.stdout))
    if sys.stderr is sys.__stderr__:
        _, sys.stderr = _wrapped(cast(io.TextIOWrapper, sys.stderr))
    try:
        yield Streams(kept, closed)
    finally:
        _flush()
        sys.stdin, sys.stdout, sys.stderr = before


def require_open(otherwise: str) -> None:
    """Raise ``InvalidInput`` where standard output takes nothing: it is closed, full, or its reader has left.

    For what can be shown only once: it is not made then, and ``otherwise`` says so. A full disk is seen by
    :func:`require_delivered` only.
    """
    if isinstance(_raw(), _Dropped):
        raise _undelivered("it is closed", otherwise)
    kept = _kept()
    if kept is None or not hasattr(select, "poll"):  # Windows has none
        return
    heard = select.poll()
    heard.register(kept.fileno(), select.POLLOUT)
    if not any(states == select.POLLOUT for _, states in heard.poll(_READER_MS)):
        raise _undelivered("nobody reads it", otherwise)


def require_delivered(otherwise: str) -> None:
    """Write out what was printed; raises ``InvalidInput`` unless standard output took all of it."""
    sys.stdout.flush()
    kept = _kept()
    if kept is not None and kept.failure is not None:
        failure, kept.failure = kept.failure, None  # told here, and not at the end of the command again
        raise _undelivered(failure.strerror or str(failure), otherwise)


def _kept() -> _Kept | None:
    raw = _raw()
    return raw if isinstance(raw, _Kept) else None


def _raw() -> Any:
    return getattr(getattr(sys.stdout, "buffer", None), "raw", None)


def _undelivered(reason: str, otherwise: str) -> InvalidInput:
    required = "one that accepts output"
    return InvalidInput(
        f"standard output: required {required}, received one that does not ({reason}); {otherwise}",
        field="standard output",
        required=required,
        received=reason,
    )


class _Closed(io.RawIOBase):
    """Standard input of a process that was started without one; a command that asks for it says so."""

    def readable(self) -> bool:
        """Whoever reads gets the error below."""
        return True

    def readinto(self, _: Any, /) -> int:
        """Raise ``OSError``."""
        raise OSError(errno.EBADF, "it is closed")


class _Dropped(io.RawIOBase):
    """An output of a process that was started without one: it keeps nothing but how much it was.

    ``number`` is the file number that :func:`_occupy` keeps for it: children write there.
    """

    length = 0

    def __init__(self, number: int) -> None:
        super().__init__()
        self._number = number

    def fileno(self) -> int:
        """The number of the null device in its place."""
        return self._number

    def writable(self) -> bool:
        """It takes everything."""
        return True

    def write(self, data: Any, /) -> int:
        """Drop the data."""
        size = memoryview(data).nbytes
        self.length += size
        return size


def _written() -> bool:
    raw = _raw()
    return isinstance(raw, _Dropped) and raw.length > 0


def _occupy() -> None:
    """Open the closed ones of the first three file numbers: output must never go into a database file."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(number, True)
    os.close(number)


def _wrapped(stream: io.TextIOWrapper) -> tuple[_Kept, io.TextIOWrapper]:
    stream.flush()
    raw = _Kept(stream.fileno(), "w", closefd=False)
    return raw, io.TextIOWrapper(
        io.BufferedWriter(raw),
        stream.encoding,
        _WRITABLE,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        stream.flush()


def run_command(run: Callable[[], object]) -> NoReturn:
    """Be a process of ours: run a command, end with its exit code; our own errors are one line and code 2."""
    own_configuration()
    with patient_streams() as streams:
        code = streams.code(exit_code(run))
    sys.exit(code)
