"""A file for a long answer on its way from a helper process: through a pipe it would be in memory four times."""

from __future__ import annotations

import logging
import os
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import cache
from io import FileIO
from itertools import chain
from pathlib import Path
from typing import BinaryIO

LONG_BYTES = 1_000_000
"""A body longer than this goes through a file."""

log = logging.getLogger("safestart.service")


class Place:
    """An open file of one request, which the helper process finds by its name.

    The name is new, also beside services that were forked from this one, and goes before the answer is sent: what is
    killed then leaves nothing behind.
    """

    def __init__(self) -> None:
        number, name = tempfile.mkstemp(prefix="safestart-")
        self.path = Path(name)
        self._file: BinaryIO | None = os.fdopen(number, "rb")

    def taken(self) -> BinaryIO:
        """The open file, which is the caller's from here on."""
        found, self._file = self._file, None
        assert found is not None
        return found

    def close(self) -> None:
        """Remove the name, and the file where nobody has taken it."""
        if self._file is not None:
            self._file.close()
        with suppress(OSError):  # somebody else has removed it, or its folder
            self.path.unlink()


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


def put(path: Path | None, parts: Iterable[bytes]) -> tuple[bytes, bool]:
    """All parts as one, or nothing, and whether they are in the file of this name instead, which must be there.

    Up to :data:`LONG_BYTES` need no file; more go without where there is none, or it is full. Nobody waits for an
    answer whose file is gone.
    """
    parts, held, length = iter(parts), [], 0
    for part in parts:
        held.append(part)
        length += len(part)
        if length > LONG_BYTES:
            break
    if length > LONG_BYTES and path is not None:
        with suppress(OSError), path.open("r+b", buffering=0) as file:
            return _written(file, chain(held, parts))
    return b"".join(chain(held, parts)), False


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
