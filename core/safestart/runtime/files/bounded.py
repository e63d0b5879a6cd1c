"""Reading within a bound: a device, a pipe or a file of holes never ends, and memory does."""

from __future__ import annotations

from pathlib import Path
from stat import S_ISREG
from typing import BinaryIO

from safestart.errors import InvalidInput, invalid


def bytes_within(field: str, path: Path | str, most: int) -> bytes:
    """The bytes of a file; raises ``InvalidInput`` naming ``field`` for more than ``most``, and ``OSError``.

    Checks the stated length first, and reads at most ``most`` bytes whatever it was.
    """
    place = Path(path)
    with place.open("rb") as file:
        size = place.stat()
        if S_ISREG(size.st_mode) and size.st_size > most:
            raise _too_long(field, most, f"{place.name} with {size.st_size}")
        return stream_within(field, file, most, place.name)


def stream_within(field: str, stream: BinaryIO, most: int, name: str) -> bytes:
    """All bytes of a stream that is called ``name``; raises as :func:`bytes_within`."""
    data = stream.read(most + 1)
    if len(data) > most:
        raise _too_long(field, most, f"{name} with more")
    return data


def _too_long(field: str, most: int, received: str) -> InvalidInput:
    return invalid(field, f"at most {most} bytes", received)
