"""The common form of KVN and XML: a sequence of keywords with values, begins and ends of blocks, and data rows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum

from safestart.errors import InvalidInput, invalid
from safestart.model.plain_text import require_line


class Kind(StrEnum):
    """A keyword with its value, the begin or end of a block, a row of a block."""

    KEY = "key"
    BEGIN = "begin"
    END = "end"
    ROW = "row"


@dataclass(frozen=True, slots=True)
class Token:
    """``name`` of a keyword or block, its ``value`` or row, its ``units``, and its ``line`` in the file."""

    kind: Kind
    name: str = ""
    value: str = ""
    units: str = ""
    line: int = 0


@dataclass(slots=True)
class Fields:
    """Keywords of one block, each once; ``line`` is where it begins. :meth:`done` refuses keywords that nobody took."""

    block: str
    line: int = 0
    values: dict[str, Token] = field(default_factory=dict)
    taken: set[str] = field(default_factory=set)

    def add(self, token: Token) -> None:
        """Add a keyword; raises ``InvalidInput`` for a repeated one."""
        if token.name in self.values:
            raise refused(token.line, f"{token.name} once in {self.block}", "it twice")
        self.values[token.name] = token

    def has(self, name: str) -> bool:
        """Whether the block has the keyword."""
        return name in self.values

    def get(self, name: str, default: str | None = None) -> str:
        """The value, or ``default``; raises ``InvalidInput`` for a keyword that is missing or empty without one."""
        self.taken.add(name)
        token = self.values.get(name)
        if token is None or not token.value:
            if default is None:
                raise refused(self.line, f"{name} in {self.block}", "none")
            return default
        return token.value

    def number(self, name: str, units: str, power: int = 0) -> float:
        """A number in SI: the value times 10^power; raises ``InvalidInput`` for other units than ``units``."""
        text = self.get(name)
        token = self.values[name]
        if token.units and token.units.lower() != units.lower():
            raise refused(token.line, f"{name} in {units}", f"[{token.units}]")
        return number(text, token.line, name, power)

    def columns_units(self, name: str) -> list[str]:
        """The units that a keyword lists for its columns, in KVN or XML; empty without it."""
        self.taken.add(name)
        token = self.values.get(name)
        # KVN takes a value in brackets for the units of the keyword.
        told = "" if token is None else token.value.strip("[] ") or token.units
        return [unit.strip() for unit in told.split(",")] if told else []

    def done(self, known: Iterable[str] = ()) -> None:
        """Raise ``InvalidInput`` for a keyword that is neither taken nor ``known`` nor user-defined."""
        known = set(known)
        for name, token in self.values.items():
            if name not in self.taken and name not in known and not name.startswith("USER_DEFINED_"):
                raise refused(token.line, f"a keyword of {self.block}", name)


def written(token: Token) -> Token:
    """The token, for a message; raises ``InvalidInput`` where a text of it is more than a line."""
    for text in (token.name, token.value, token.units):
        require_line(token.name or "row", text)
    return token


def refused(line: int, required: str, received: object) -> InvalidInput:
    """The error at a line of a file."""
    return invalid(f"line {line}" if line else "file", required, received)


def number(text: str, line: int, name: str, power: int = 0) -> float:
    """The double nearest to the decimal times 10^power; raises ``InvalidInput`` for anything but a finite number."""
    try:
        # Move the exponent in the text, so that kilometres become metres with one rounding.
        mantissa, _, exponent = text.lower().partition("e")
        value = float(f"{mantissa}e{int(exponent or 0) + power}" if power else text)
    except ValueError:
        value = float("nan")
    if not abs(value) < 1e300 or "_" in text or not text.isascii():
        raise refused(line, f"{name}: a finite number", text)
    return value


def decimal(value: float, power: int = 0) -> str:
    """The shortest text that :func:`number` reads back as the same double."""
    text = repr(float(value))
    if not power:
        return text
    mantissa, _, exponent = text.partition("e")
    sign, digits = ("-", mantissa[1:]) if mantissa.startswith("-") else ("", mantissa)
    whole, _, part = digits.partition(".")
    shift = int(exponent or 0) - power
    if -12 <= shift <= 12:
        # Written without an exponent, which most readers expect.
        both, point = whole + part, len(whole) + shift
        if point <= 0:
            both, point = "0" * (1 - point) + both, 1
        both = both.ljust(point, "0")
        head, tail = both[:point].lstrip("0") or "0", both[point:].rstrip("0") or "0"
        return f"{sign}{head}.{tail}"
    return f"{mantissa}e{shift}"


def blocks_of(tokens: Iterable[Token]) -> Iterator[Token]:
    """The tokens, with every begin closed by its end; raises ``InvalidInput`` if a file stops inside a block."""
    opened: list[Token] = []
    for token in tokens:
        if token.kind is Kind.BEGIN:
            if opened:
                raise refused(
                    token.line, f"{opened[-1].name}_STOP before another block", f"{token.name}_START"
                )
            opened.append(token)
        elif token.kind is Kind.END:
            if not opened or opened[-1].name != token.name:
                raise refused(token.line, f"{token.name}_START before its end", f"{token.name}_STOP")
            opened.pop()
        yield token
    if opened:
        raise refused(opened[-1].line, f"{opened[-1].name}_STOP", "the end of the file (truncated)")
