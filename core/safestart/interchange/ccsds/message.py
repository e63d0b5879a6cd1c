"""A message split into header and blocks, the same for every kind."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from safestart.errors import invalid
from safestart.interchange.ccsds import kvn, xml_form
from safestart.interchange.ccsds.tokens import Fields, Kind, Token, blocks_of, refused
from safestart.interchange.epochs import require_epoch
from safestart.interchange.foreign import refuse_foreign
from safestart.interchange.source import text_of

VERSIONS = {
    "OEM": ("1.0", "2.0", "3.0"),
    "OPM": ("1.0", "2.0", "3.0"),
    "OCM": ("3.0",),
    "AEM": ("1.0", "2.0"),
    "ACM": ("2.0",),
    "APM": ("1.0", "2.0"),
    "CDM": ("1.0",),
}
# The keyword that begins another block of the same name, by kind of message and block.
_AGAIN = {
    ("OEM", "COVARIANCE"): "EPOCH",
    ("OPM", ""): "MAN_EPOCH_IGNITION",
    ("APM", ""): "MAN_EPOCH_START",
    ("CDM", ""): "OBJECT",
}
_HEADER = ("CLASSIFICATION", "CREATION_DATE", "ORIGINATOR", "MESSAGE_ID", "MESSAGE_FOR")


@dataclass(slots=True)
class Block:
    """Keywords and rows of one block; ``name`` is "" outside of blocks."""

    name: str
    fields: Fields
    rows: list[Token] = field(default_factory=list)


@dataclass(slots=True)
class Message:
    """``kind`` is OEM, OPM, ...; ``header`` its keywords, ``body`` the tokens after them."""

    kind: str
    version: str
    header: dict[str, str]
    body: list[Token]

    def blocks(self) -> Iterator[Block]:
        """Blocks in their order; keywords and rows between blocks make blocks without a name."""
        current: Block | None = None
        for token in blocks_of(self.body):
            if token.kind is Kind.BEGIN:
                if current is not None:
                    yield current
                current = Block(token.name, Fields(token.name, token.line))
            elif token.kind is Kind.END:
                if current is not None:
                    yield current
                current = None
            else:
                if current is None:
                    current = Block("", Fields(self.kind, token.line))
                elif self._again(token, current):
                    yield current
                    current = Block(current.name, Fields(current.fields.block, token.line))
                if token.kind is Kind.KEY:
                    current.fields.add(token)
                else:
                    current.rows.append(token)
        if current is not None:
            yield current

    def _again(self, token: Token, current: Block) -> bool:
        """Whether this token begins another block of the same name: a covariance, a burn, an object."""
        if token.kind is not Kind.KEY or token.name != _AGAIN.get((self.kind, current.name)):
            return False
        return token.name in current.fields.values or not current.name


def message_of(data: bytes) -> Message:
    """The message in a file's bytes, KVN or XML; raises ``InvalidInput`` for other bytes, ``Unavailable``."""
    refuse_foreign(data)
    if data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"<":
        tokens: Iterable[Token] = xml_form.tokens_of(data)
    else:
        tokens = kvn.tokens_of(text_of(data, "file"))
    stream = iter(tokens)
    first = next(stream, None)
    known = ", ".join(f"CCSDS_{kind}_VERS" for kind in VERSIONS)
    if first is None:
        raise invalid("file", f"a message that begins with one of {known}", "an empty file")
    parts = first.name.split("_")
    if first.kind is not Kind.KEY or len(parts) != 3 or parts[0] != "CCSDS" or parts[1] not in VERSIONS:
        raise refused(first.line, f"one of {known} first", first.name or first.value)
    kind = parts[1]
    if first.value not in VERSIONS[kind]:
        raise refused(first.line, f"version {' or '.join(VERSIONS[kind])} of {kind}", first.value)
    header: dict[str, str] = {}
    body: list[Token] = []
    for token in stream:
        if not body and token.kind is Kind.KEY and token.name in _HEADER:
            if token.name in header:
                raise refused(token.line, f"{token.name} once in the header", "it twice")
            header[token.name] = token.value
        elif token.name.startswith("CCSDS_") and token.name.endswith("_VERS"):
            raise refused(token.line, "one message in a file", token.name)
        else:
            body.append(token)
    return Message(kind, first.value, header, body)


def header_of(kind: str, version: str, created: str, originator: str) -> list[Token]:
    """The tokens with which a message begins; raises ``InvalidInput`` unless it was ``created`` at an epoch."""
    require_epoch("CREATION_DATE", created)
    return [
        Token(Kind.KEY, f"CCSDS_{kind}_VERS", version),
        Token(Kind.KEY, "CREATION_DATE", created),
        Token(Kind.KEY, "ORIGINATOR", originator),
    ]


def key(name: str, value: str, units: str = "") -> Token:
    """A keyword's token."""
    return Token(Kind.KEY, name, value, units)


def block(name: str, inside: Iterable[Token]) -> list[Token]:
    """A block's tokens."""
    return [Token(Kind.BEGIN, name), *inside, Token(Kind.END, name)]
