"""Files that the commands read and write; an unusable file is bad input, named by its option."""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from stat import S_ISREG
from typing import Any, BinaryIO

from safestart.errors import InvalidInput, invalid
from safestart.runtime.files.bounded import bytes_within, stream_within
from safestart.runtime.plain_json import NameTwice, loads

MOST_INPUT_BYTES = 64 * 1024 * 1024
"""Of a file of inputs: eight times the longest body that a service takes by default."""


@contextmanager
def readable(option: str, path: Path | str) -> Iterator[None]:
    """Raise ``InvalidInput`` for ``option`` when the block cannot read ``path``."""
    with _refused(option, "a readable file", path):
        yield


@contextmanager
def writable(option: str, path: Path) -> Iterator[None]:
    """Raise ``InvalidInput`` for ``option`` when the block cannot write ``path``."""
    with _refused(option, "a writable path", path):
        yield


def given_bytes(option: str, source: str, most: int) -> bytes:
    """The bytes of a file, or of standard input for ``-``.

    Raises ``InvalidInput`` for more than ``most``, and ``OSError``.
    """
    if source == "-":
        # A test or a notebook may have put one there that holds text alone.
        stream = getattr(sys.stdin, "buffer", None) or io.BytesIO(sys.stdin.read(most + 1).encode())
        return stream_within(option, stream, most, "standard input")
    return bytes_within(option, source, most)


def read_json(option: str, source: str) -> Any:
    """The JSON of a file, or of standard input for ``-``; raises ``InvalidInput`` for ``option``."""
    try:
        with readable(option, source):
            text = given_bytes(option, source, MOST_INPUT_BYTES).decode()
    except UnicodeDecodeError:
        raise invalid(option, "UTF-8 text", source) from None
    try:
        return loads(text)
    except NameTwice as error:
        raise invalid(option, "JSON with every name once in an object", str(error)) from None
    except (ValueError, RecursionError) as error:
        raise InvalidInput(f"{option}: required JSON, received text that is not ({error})") from None


class Target:
    """A file that is opened before the work; its old content stays until the result is written."""

    def __init__(self, option: str, path: Path, file: BinaryIO) -> None:
        self._option = option
        self.path = path
        self._file = file

    def write(self, data: bytes) -> None:
        """Write all of it; raises ``InvalidInput``."""
        with writable(self._option, self.path):
            if S_ISREG(os.fstat(self._file.fileno()).st_mode):  # a pipe or a device holds nothing
                self._file.truncate(0)
            self._file.write(data)
            self._file.flush()

    def write_json(self, document: Any, indent: int | None = None) -> None:
        """Write a document as JSON in UTF-8 with a newline at its end; raises ``InvalidInput``."""
        self.write((json.dumps(document, allow_nan=False, indent=indent) + "\n").encode())


@contextmanager
def target(option: str, path: Path | None) -> Iterator[Target | None]:
    """Open ``path`` for the block; None for None. Raises ``InvalidInput``, also where its directory is missing.

    A misspelt directory that were made would hide the result. The block removes a new file when it fails.
    """
    if path is None:
        yield None
        return
    with writable(option, path):
        new = not path.exists()
        file = path.open("ab", buffering=0)
    try:
        with file:
            yield Target(option, path, file)
    except BaseException:
        if new:
            path.unlink(missing_ok=True)
        raise


@contextmanager
def folder(option: str, path: Path | None) -> Iterator[None]:
    """Make the directory ``path`` for the block, before its work; its parent must be there. Raises ``InvalidInput``.

    The block removes a new directory when it fails and left nothing in it.
    """
    if path is None:
        yield
        return
    with _refused(option, "a directory, or a name for one in a directory that is there", path):
        new = not path.is_dir()
        path.mkdir(exist_ok=True)
    try:
        yield
    except BaseException:
        if new:
            with suppress(OSError):
                path.rmdir()
        raise


@contextmanager
def _refused(option: str, required: str, path: Path | str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise invalid(option, required, f"{path} ({error.strerror or error})") from None
