"""Standard streams that take no command down: a reader that left is met with silence, a full disk with one sentence.

What a command finds is its exit code, too: a proof that is rejected stays rejected when nobody reads why. So a write
that fails raises nothing in the middle of the work. It is remembered, and told at the end.
"""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, cast

NOT_WRITTEN = 2


class _Kept(io.FileIO):
    """A file whose first failure to write is kept; what comes later is dropped."""

    failure: OSError | None = None

    def write(self, data: Any, /) -> int | None:
        """Write, or act as if."""
        if self.failure is None:
            try:
                return super().write(data)
            except OSError as error:
                self.failure = error
        return memoryview(data).nbytes


class Streams:
    """The standard output and error of this process while a command runs."""

    def __init__(self, stdout: _Kept | None, closed: bool) -> None:
        self._stdout = stdout
        self._closed = closed

    def code(self, code: int) -> int:
        """The exit code of a command that ended with ``code``, after everything was written, or was not."""
        _flush()
        reason = "it is closed" if self._closed and _written() else None
        failure = None if self._stdout is None else self._stdout.failure
        if (
            failure is not None and failure.errno != errno.EPIPE
        ):  # the reader (head, less) left: nothing is wrong
            reason = failure.strerror
        if reason is None:
            return code
        sys.stderr.write(f"safestart: standard output: required one that takes what is written ({reason})\n")
        _flush()
        return code or NOT_WRITTEN


@contextmanager
def patient_streams() -> Iterator[Streams]:
    """Replace the real standard streams for the block; those that a test or a notebook has put there stay."""
    closed = sys.stdout is None
    _occupy()
    before = sys.stdin, sys.stdout, sys.stderr
    if sys.stdin is None:
        sys.stdin = io.StringIO()
    if closed:
        sys.stdout = _Counted()
    if sys.stderr is None:
        sys.stderr = io.StringIO()
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


class _Counted(io.StringIO):
    """Stands for a standard output that was closed before we began."""


def _written() -> bool:
    return isinstance(sys.stdout, _Counted) and bool(sys.stdout.tell())


def _occupy() -> None:
    """Open what is closed of the first three files: a database that got one of their numbers would be written into."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(number, True)
    os.close(number)


def _wrapped(stream: io.TextIOWrapper) -> tuple[_Kept, io.TextIOWrapper]:
    stream.flush()
    raw = _Kept(stream.fileno(), "w", closefd=False)
    return raw, io.TextIOWrapper(
        io.BufferedWriter(raw),
        stream.encoding,
        stream.errors,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
