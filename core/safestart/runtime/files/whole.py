"""Files that appear at their names whole, all of a set together; a full disk leaves what was there before."""

from __future__ import annotations

import os
import secrets
from contextlib import suppress
from io import FileIO
from pathlib import Path
from stat import S_IMODE, S_ISREG
from types import TracebackType
from typing import Self

_MOST_LINKS = 40
"""As many as Linux follows."""


class Whole:
    """A set of files for a block: at its end each is at its name, or, when it fails, none of them.

    A file is written beside its name and renamed. What cannot be replaced is written as it is: pipes, devices, and
    files in folders that take no new ones.
    """

    def __init__(self) -> None:
        self._files: list[File] = []

    def open(self, path: Path) -> File:
        """A file of the set, whose place is there from now on; raises ``OSError``."""
        self._files.append(File(path))
        return self._files[-1]

    def add(self, path: Path, data: bytes) -> None:
        """A file with its content; raises ``OSError``."""
        file = self.open(path)
        file.write(data)
        file.close()  # a set may be larger than the number of files that a process may have open

    def appear(self) -> None:
        """Be at their names; raises ``OSError``."""
        for one in self._files:
            one.close()
        for one in self._files:
            one.appear()

    def drop(self) -> None:
        """Leave nothing else behind, whether they have appeared or not."""
        for one in self._files:
            one.drop()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if kind is None:
                self.appear()
        finally:
            self.drop()


class File:
    """One file of the set. Without a write, what was at its name stays."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._final = Path(os.path.realpath(path))
        self._draft: Path | None = None
        self._written = False
        before = _mode(path)
        self._replaces = before is None or (S_ISREG(before) and not _is_open_file(path))
        if before is not None:
            self._file = _in_place(path)  # what may not be written is not replaced either
        if self._replaces:
            self._begin(before)

    def _begin(self, before: int | None) -> None:
        draft = self._final.with_name(f".safestart-{secrets.token_hex(8)}.part")
        try:
            made = FileIO(draft, "x")
        except PermissionError:
            if before is None:
                raise
            return  # written in place
        if before is not None:
            self._file.close()
            os.chmod(draft, S_IMODE(before))
        self._file, self._draft = made, draft

    def write(self, data: bytes) -> None:
        """Write all of it, in the place of what was written before; raises ``OSError``."""
        if self._replaces:
            self._file.truncate(0)
            self._file.seek(0)
        _write_all(self._file, data)
        self._written = True

    def close(self) -> None:
        """Nothing more is written; raises ``OSError``, as some disks say only now that they are full."""
        self._file.close()

    def appear(self) -> None:
        """Be at its name; raises ``OSError``."""
        if self._draft is None or not self._written:
            return
        try:
            os.replace(self._draft, self._final)
        except PermissionError:  # somebody else's file, where each may replace only their own
            with _in_place(self._final) as file:
                file.truncate(0)
                _write_all(file, self._draft.read_bytes())
        else:
            self._draft = None

    def drop(self) -> None:
        """Leave nothing beside its name."""
        with suppress(OSError):
            self._file.close()
        if self._draft is not None:
            self._draft.unlink(missing_ok=True)


def _mode(path: Path) -> int | None:
    """What is at a name; None for nothing. Raises ``OSError``, also for a name that cannot be one."""
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        return None


def _in_place(path: Path) -> FileIO:
    return path.open("ab", buffering=0)


def _write_all(file: FileIO, data: bytes) -> None:
    """Write all bytes: the system may take a part of them, and says so only by its number."""
    left = memoryview(data)
    while left:
        left = left[file.write(left) :]


def _is_open_file(path: Path) -> bool:
    """Whether a name leads to an open file of a process, as ``/dev/stdout`` does: others write there, too."""
    here = str(path)
    for _ in range(_MOST_LINKS):
        folder = os.path.realpath(os.path.dirname(here))
        if folder == "/dev" or folder.startswith("/proc/"):
            return True
        if not os.path.islink(here):
            return False
        here = os.path.join(folder, os.readlink(here))
    return False
