"""Named arrays of a MATLAB 5 file: numbers, texts, cells of texts.

SciPy's reader follows cells and structures as deep as a file says, and unpacks as much: a megabyte of nested cells ends
the process, and one of zeros fills the memory. What a table needs is flat, so it is read here: bounded, without
recursion. (MAT-File Format, MathWorks: level 5.)
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from safestart.errors import InvalidInput, invalid

_HEAD = 128
_MOST_UNPACKED = 256 * 1024 * 1024
_MOST_ARRAYS = 100
_MATRIX, _COMPRESSED = 14, 15
_CELL, _CHAR = 1, 4
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXTS = {1: "u1", 2: "u1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_CLASSES = {
    2: "a structure",
    3: "an object",
    5: "a sparse matrix",
    16: "a function",
    17: "an object or string",
}
_COMPLEX = 0x0800
Order = Literal["<", ">"]


@dataclass(slots=True)
class _Matrix:
    """One array: its ``kind`` (class), ``shape``, ``name``, and the bytes behind them."""

    kind: int
    flags: int
    shape: tuple[int, ...]
    name: str
    rest: memoryview

    @property
    def size(self) -> int:
        size = 1
        for one in self.shape:
            size *= one
        return size


def arrays_in(data: bytes, most: int) -> dict[str, list[Any]]:
    """Numbers or texts of each array, flat, row by row; a row of characters is one text.

    Raises ``InvalidInput`` for anything but a MATLAB 5 file, for arrays of more than ``most`` entries, for other kinds
    of arrays, and for more than 256 MB unpacked.
    """
    try:
        return _arrays_in(data, most)
    except (ValueError, IndexError, zlib.error, UnicodeDecodeError) as error:
        if isinstance(error, InvalidInput):
            raise
        raise invalid(
            "file", "a MATLAB 5 file", f"one that is damaged or truncated ({error or 'bytes missing'})"
        ) from None


def _arrays_in(data: bytes, most: int) -> dict[str, list[Any]]:
    mark = data[126:128]
    if len(data) < _HEAD or mark not in (b"IM", b"MI"):
        raise invalid("file", "a MATLAB 5 file", "one without its mark of byte order (truncated)")
    order: Order = "<" if mark == b"IM" else ">"
    found: dict[str, list[Any]] = {}
    for element in _unpacked(memoryview(data)[_HEAD:], order):
        one = _matrix(element, order)
        if not one.name or one.name.startswith("__"):
            continue
        if one.name in found:
            raise invalid("file", f"{one.name} once", "it twice")
        if len(found) == _MOST_ARRAYS:
            raise invalid("file", f"at most {_MOST_ARRAYS} arrays", "more")
        if one.size > most and one.kind != _CHAR:
            raise invalid(one.name, f"at most {most} entries", one.size)
        found[one.name] = _entries(one, order)
    return found


def _unpacked(rest: memoryview, order: Order) -> Iterator[memoryview]:
    """The matrices at the top, unpacked."""
    left = _MOST_UNPACKED
    while rest:
        kind, body, rest = _element(rest, order)
        if kind == _COMPRESSED:
            packer = zlib.decompressobj()
            plain = packer.decompress(body, left + 1)
            if len(plain) > left:
                raise invalid("file", f"at most {_MOST_UNPACKED} bytes unpacked", "more")
            if not packer.eof:
                raise ValueError("a packed array without its end")
            kind, body, _ = _element(memoryview(plain), order)
        left -= len(body)
        if left < 0:
            raise invalid("file", f"at most {_MOST_UNPACKED} bytes unpacked", "more")
        if kind != _MATRIX:
            raise ValueError(f"type {kind} in place of an array")
        yield body


def _element(data: memoryview, order: Order) -> tuple[int, memoryview, memoryview]:
    """Type and bytes of the element with which ``data`` begins, and what follows it."""
    first, size = (int(one) for one in np.frombuffer(data[:8], f"{order}u4", 2))
    if first >> 16:
        # Up to four bytes lie in the tag itself.
        kind, size = first & 0xFFFF, first >> 16
        if size > 4:
            raise ValueError("a short element of more than four bytes")
        return kind, data[4 : 4 + size], data[8:]
    if size > len(data) - 8:
        raise ValueError("bytes missing")
    # Packed arrays alone are not padded to multiples of eight bytes.
    end = 8 + size if first == _COMPRESSED else 8 + -(-size // 8) * 8
    return first, data[8 : 8 + size], data[end:]


def _matrix(body: memoryview, order: Order) -> _Matrix:
    _, flags, rest = _element(body, order)
    _, shape, rest = _element(rest, order)
    _, name, rest = _element(rest, order)
    word = int(np.frombuffer(flags, f"{order}u4", 2)[0])
    dimensions = tuple(int(one) for one in np.frombuffer(shape, f"{order}i4"))
    if len(dimensions) < 2 or min(dimensions) < 0:
        raise ValueError(f"dimensions {dimensions}")
    return _Matrix(word & 0xFF, word, dimensions, bytes(name).decode("ascii"), rest)


def _entries(one: _Matrix, order: Order) -> list[Any]:
    if one.kind == _CHAR:
        return _texts(one, order)
    if one.kind == _CELL:
        rest, out = one.rest, []
        for _ in range(one.size):
            kind, body, rest = _element(rest, order)
            inside = _matrix(body, order) if kind == _MATRIX and body else None
            if inside is None or inside.kind != _CHAR:
                raise invalid(one.name, "cells of texts", "cells of something else")
            texts = _texts(inside, order)
            if len(texts) > 1:
                raise invalid(one.name, "one text in a cell", len(texts))
            out += texts or [""]
        return out
    if not 6 <= one.kind <= 15 or one.flags & _COMPLEX:
        received = "complex numbers" if one.flags & _COMPLEX else _CLASSES.get(one.kind, f"class {one.kind}")
        raise invalid(one.name, "real numbers, texts or cells of texts", received)
    kind, body, _ = _element(one.rest, order)
    numbers = np.frombuffer(body, f"{order}{_NUMBERS[kind]}" if kind in _NUMBERS else "V")
    if len(numbers) != one.size:
        raise ValueError(f"{len(numbers)} numbers for {one.size}")
    rows = np.asarray(numbers, dtype=np.float64).reshape(one.shape, order="F")
    return rows.ravel().tolist()


def _texts(one: _Matrix, order: Order) -> list[str]:
    """A text for each row of a matrix of characters, which lie in its columns."""
    if len(one.shape) != 2:
        raise invalid(one.name, "a matrix of characters", one.shape)
    kind, body, _ = _element(one.rest, order) if one.rest else (16, memoryview(b""), None)
    if kind not in _TEXTS:
        raise ValueError(f"characters of type {kind}")
    coding = _TEXTS[kind]
    if coding == "u1":
        coding = "latin-1"
    elif coding != "utf-8":
        coding += "-le" if order == "<" else "-be"
    letters = bytes(body).decode(coding)
    rows, width = one.shape
    if len(letters) != rows * width:
        raise ValueError(f"{len(letters)} characters for {rows} x {width}")
    return [letters[row::rows].rstrip() for row in range(rows)] if width else [""] * rows
