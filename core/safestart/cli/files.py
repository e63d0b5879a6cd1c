"""Files that the commands read and write; an unusable file is bad input, named by its option."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from safestart.errors import invalid


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


def write_json(option: str, path: Path, document: Any, indent: int | None = None) -> None:
    """Write a document as JSON in UTF-8 with a newline at its end; raises ``InvalidInput``."""
    with writable(option, path):
        path.write_text(json.dumps(document, allow_nan=False, indent=indent) + "\n", encoding="utf-8")


@contextmanager
def _refused(option: str, required: str, path: Path | str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise invalid(option, required, f"{path} ({error.strerror})") from None
