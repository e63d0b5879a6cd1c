"""Bytes of a file, with a size limit before and during reading."""

from __future__ import annotations

from pathlib import Path

from safestart.errors import InvalidInput, invalid
from safestart.runtime.files.bounded import bytes_within

MOST_BYTES = 64 * 1024 * 1024
"""Largest file that is read: a day of states every second with covariance has about 40 MB."""

_BREAKS = "\n\r\x0b\x0c\x1c\x1d\x1e\x85\u2028\u2029"


def bytes_of(path: Path | str, most: int = MOST_BYTES) -> bytes:
    """The file's bytes; raises ``InvalidInput`` when it is missing, not a file, or longer than ``most`` bytes."""
    try:
        return bytes_within("file", path, most)
    except OSError as error:
        raise InvalidInput(f"file: required a readable file, received {path} ({error.strerror})") from None


def text_of(data: bytes, name: str) -> str:
    """UTF-8 text without a byte order mark; raises ``InvalidInput``."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise invalid(name, "UTF-8 text", f"byte {data[error.start]:#04x} at {error.start}") from None
    if "\x00" in text:
        raise invalid(name, "text without NUL characters", "NUL")
    return text


def refuse_many_lines(text: str, most: int) -> None:
    """Raise ``InvalidInput`` for a text of more than ``most`` lines, before it is split: each line costs memory."""
    # A line that ends in CR LF counts once, by the larger count.
    lines = max(text.count("\n"), text.count("\r")) + sum(text.count(one) for one in _BREAKS[2:])
    if lines > most:
        raise invalid("file", f"at most {most} lines", lines)
