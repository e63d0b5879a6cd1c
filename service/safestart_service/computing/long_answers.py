"""A file for a long answer on its way from a helper process: through a pipe it would be in memory four times."""

from __future__ import annotations

import logging
import os
import secrets
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from io import FileIO
from itertools import chain
from pathlib import Path

LONG_BYTES = 1_000_000
"""A body longer than this goes through a file."""

log = logging.getLogger("safestart.service")


@dataclass(frozen=True, slots=True)
class Where:
    """Where a helper process finds a file, which begins with ``mark``.

    The number of an open file is given to another one when it is closed: a helper that comes late finds the file of
    another answer there, and lets it alone.
    """

    path: Path
    mark: bytes


class Place:
    """An open file of one request, for its helper process.

    On Linux it has no name, so that nothing is left of it when the service is killed, and a helper finds it among the
    open files of the service. Elsewhere its name is new, and goes before the answer is sent.
    """

    def __init__(self) -> None:
        opened, self._named = _opened()
        self._file: FileIO | None = opened
        here = Path(f"/proc/{os.getpid()}/fd/{opened.fileno()}")
        self.where = Where(self._named or here, secrets.token_bytes(16))
        try:
            opened.write(self.where.mark)
        except OSError:
            self.close()
            raise
        opened.seek(0)

    def taken(self) -> FileIO:
        """The open file, which is the caller's from here on."""
        found, self._file = self._file, None
        assert found is not None
        return found

    def close(self) -> None:
        """Remove the name, and the file where nobody has taken it."""
        if self._file is not None:
            self._file.close()
        self._remove()

    def _remove(self) -> None:
        if self._named is not None:
            with suppress(OSError):  # somebody else has removed it, or its folder
                self._named.unlink()
            self._named = None


def _opened() -> tuple[FileIO, Path | None]:
    """A new file, and its name where it has one."""
    if Path("/proc/self/fd").is_dir():
        return tempfile.TemporaryFile(buffering=0), None
    number, name = tempfile.mkstemp(prefix="safestart-")
    return os.fdopen(number, "r+b", buffering=0), Path(name)


def place() -> Place | None:
    """A new one; None where nothing can be written."""
    try:
        return Place()
    except OSError as error:
        _say(str(error.strerror))
        return None


@cache
def _say(why: str) -> None:
    log.warning("no place for temporary files (%s): long answers take more memory", why)


def put(where: Where | None, parts: Iterable[bytes]) -> tuple[bytes, bool]:
    """All parts as one, or nothing, and whether they are in this file instead, which must be there.

    Up to :data:`LONG_BYTES` need no file; more go without where there is none, it may not be opened, or is full.
    Nobody waits for an answer whose file is gone.
    """
    parts, held, length = iter(parts), [], 0
    for part in parts:
        held.append(part)
        length += len(part)
        if length > LONG_BYTES:
            break
    if length > LONG_BYTES and where is not None:
        file = _found(where)
        if file is not None:
            with file:  # what fails from here on is an error: half an answer is none
                return _written(file, chain(held, parts))
    return b"".join(chain(held, parts)), False


def _found(where: Where) -> FileIO | None:
    with suppress(OSError):
        file = where.path.open("r+b", buffering=0)
        try:
            if file.read(len(where.mark) + 1) == where.mark:
                file.seek(0)
                return file
        except OSError:
            pass
        file.close()
    return None


def _written(file: FileIO, parts: Iterator[bytes]) -> tuple[bytes, bool]:
    length = 0
    for part in parts:
        try:
            left = memoryview(part)
            while left:
                left = left[file.write(left) :]
        except OSError:  # it is full
            file.seek(0)
            return b"".join(chain((file.readall()[:length], part), parts)), False
        length += len(part)
    return b"", True
