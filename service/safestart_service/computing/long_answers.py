"""A file for a long answer on its way from a helper process: through a pipe it would be in memory four times."""

from __future__ import annotations

import logging
import os
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import BinaryIO

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


def write(path: Path | None, body: bytes) -> bool:
    """Whether a body could be written into the file of this name, which must be there.

    Nobody waits for an answer whose file is gone.
    """
    if path is None:
        return False
    with suppress(OSError), path.open("r+b") as file:
        file.write(body)
        return True
    return False
