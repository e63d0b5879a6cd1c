"""Files that the commands read and write; an unusable file is bad input, named by its option."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from safestart.errors import InvalidInput, invalid
from safestart.runtime.files.bounded import bytes_within, stream_within
from safestart.runtime.files.whole import File, Whole
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
    """A file that is opened before the work, and files beside it; see :class:`~safestart.runtime.files.whole.Whole`."""

    def __init__(self, option: str, file: File, files: Whole) -> None:
        self._option = option
        self._file = file
        self._files = files
        self.written = [file.path]

    def write(self, data: bytes) -> None:
        """Write all of it; raises ``InvalidInput``."""
        with writable(self._option, self._file.path):
            self._file.write(data)

    def write_json(self, document: Any, indent: int | None = None) -> None:
        """Write a document as JSON in UTF-8 with a newline at its end; raises ``InvalidInput``."""
        self.write((json.dumps(document, allow_nan=False, indent=indent) + "\n").encode())

    def write_beside(self, name: str, data: bytes) -> None:
        """Write ``STEM.name`` beside ``STEM.json``; raises ``InvalidInput``."""
        path = self._file.path.with_name(f"{self._file.path.stem}.{name}")
        with writable(self._option, path):
            self._files.add(path, data)
        self.written.append(path)


@contextmanager
def target(option: str, path: Path | None) -> Iterator[Target | None]:
    """Open ``path`` for the block; None for None. Raises ``InvalidInput``, also where its directory is missing.

    A misspelt directory that were made would hide the result. What was written is at its name when the block has ended;
    where the block fails, nothing has changed.
    """
    if path is None:
        yield None
        return
    files = Whole()
    try:
        with writable(option, path):
            file = files.open(path)
        yield Target(option, file, files)
        with writable(option, path):
            files.appear()
    finally:
        files.drop()


class Folder:
    """A directory that is made before the work, and files in it."""

    def __init__(self, option: str, path: Path, files: Whole) -> None:
        self._option = option
        self._path = path
        self._files = files

    def write_json(self, name: str, document: Any) -> None:
        """Write a document as JSON in UTF-8 with a newline at its end; raises ``InvalidInput``."""
        with writable(self._option, self._path):
            self._files.add(self._path / name, (json.dumps(document) + "\n").encode())


@contextmanager
def folder(option: str, path: Path | None) -> Iterator[Folder | None]:
    """Make the directory ``path`` for the block, before its work; its parent must be there. Raises ``InvalidInput``.

    What was written is there when the block has ended. Where the block fails nothing has changed, and no new directory
    stays.
    """
    if path is None:
        yield None
        return
    with _refused(option, "a directory, or a name for one in a directory that is there", path):
        new = not path.is_dir()
        path.mkdir(exist_ok=True)
    files = Whole()
    try:
        yield Folder(option, path, files)
        with writable(option, path):
            files.appear()
    except BaseException:
        files.drop()
        if new:
            with suppress(OSError):
                path.rmdir()
        raise
    files.drop()


@contextmanager
def _refused(option: str, required: str, path: Path | str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise invalid(option, required, f"{path} ({error.strerror or error})") from None
