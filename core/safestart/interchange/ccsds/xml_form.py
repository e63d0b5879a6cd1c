"""The XML form of CCSDS messages (505.0-B-3) as the tokens of KVN, and back.

Document types are refused: declarations of entities, and so entity bombs and external files, raise an error. What
parsing costs is bounded by what the bytes hold, before they are parsed.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from xml.etree.ElementTree import Element, ParseError

from safestart.errors import Unavailable, invalid
from safestart.interchange.ccsds.tokens import Kind, Token

TRIANGLE = tuple(
    f"C{row}_{column}"
    for k, row in enumerate(("X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT"))
    for column in ("X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT")[: k + 1]
)
"""The lower triangle of a covariance, row by row."""
STATE = ("EPOCH", "X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT", "X_DDOT", "Y_DDOT", "Z_DDOT")
_TURN, _TURN_SCALAR_FIRST = ("EPOCH", "Q1", "Q2", "Q3", "QC"), ("EPOCH", "QC", "Q1", "Q2", "Q3")
# Containers that are blocks in KVN, by kind of message; other containers are ignored.
_BLOCKS = {
    "oem": {"metadata": "META", "covarianceMatrix": "COVARIANCE"},
    "aem": {"metadata": "META", "data": "DATA"},
    "ocm": {"metadata": "META", "traj": "TRAJ", "cov": "COV", "man": "MAN", "phys": "PHYS", "od": "OD"},
    "acm": {
        "metadata": "META",
        "att": "ATT",
        "phys": "PHYS",
        "cov": "COV",
        "man": "MAN",
        "ad": "AD",
        "user": "USER",
    },
    "opm": {},
    "apm": {},
    "cdm": {},
}
_UNITS = {
    **dict.fromkeys(("X", "Y", "Z"), "km"),
    **dict.fromkeys(("X_DOT", "Y_DOT", "Z_DOT"), "km/s"),
    **dict.fromkeys(("X_DDOT", "Y_DDOT", "Z_DDOT"), "km/s**2"),
    **{name: ("km**2", "km**2/s", "km**2/s**2")[name.count("DOT")] for name in TRIANGLE},
}
_LINES = {"trajLine", "attLine", "covLine", "manLine"}
_LARGEST_DEPTH = 12
_MOST_TAGS = 6_000_000
"""Begins and ends of elements: as many as 64 MB of numbers have, each in tags of its own."""
_LONG_TAG = re.compile(rb"<[^<>]{4096}")
"""The parser's time grows with the square of a tag's attributes."""


def tokens_of(data: bytes) -> Iterator[Token]:
    """The tokens of an XML message, ``CCSDS_kind_VERS`` first; raises ``InvalidInput``, ``Unavailable``."""
    root = _root(data)
    kind = _name(root)
    if kind not in _BLOCKS:
        raise invalid("file", f"one message: {', '.join(_BLOCKS)}", f"<{kind}>")
    if root.get("id") != f"CCSDS_{kind.upper()}_VERS":
        raise invalid("file", f'<{kind} id="CCSDS_{kind.upper()}_VERS">', root.get("id"))
    yield Token(Kind.KEY, f"CCSDS_{kind.upper()}_VERS", root.get("version", ""))
    yield from _inside(root, kind, 0)


def _root(data: bytes) -> Element:
    try:
        from defusedxml.common import DefusedXmlException
        from defusedxml.ElementTree import parse
    except ModuleNotFoundError:
        raise Unavailable(
            "XML requires the package defusedxml (extra files)", required="defusedxml"
        ) from None
    tags = data.count(b"<")
    if tags > _MOST_TAGS:
        raise invalid("file", f"at most {_MOST_TAGS} tags", tags)
    if _LONG_TAG.search(data):
        raise invalid("file", "tags of at most 4096 characters", "a longer one")
    try:
        root = parse(io.BytesIO(data), forbid_dtd=True).getroot()
    except DefusedXmlException as error:
        raise invalid("file", "XML without document type and entities", type(error).__name__) from None
    except (ParseError, ValueError, LookupError) as error:
        raise invalid("file", "well-formed XML", str(error)) from None
    if not isinstance(root, Element):
        raise invalid("file", "an XML document", "an empty one")
    return root


def _name(element: Element) -> str:
    tag = element.tag
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""


def _inside(element: Element, kind: str, depth: int, turn: tuple[str, ...] = _TURN) -> Iterator[Token]:
    if depth > _LARGEST_DEPTH:
        raise invalid("file", f"at most {_LARGEST_DEPTH} levels of elements", "more")
    if element.findtext("{*}metadata/{*}QUATERNION_TYPE", "").strip() == "FIRST":
        turn = _TURN_SCALAR_FIRST
    for child in element:
        name = _name(child)
        if not name or name == "COMMENT":
            continue
        if kind == "oem" and name == "stateVector":
            yield _row(child, STATE)
        elif kind == "aem" and name == "attitudeState":
            yield _row(child, turn)
        elif name in _LINES:
            yield Token(Kind.ROW, value=" ".join((child.text or "").split()))
        elif name in _BLOCKS[kind]:
            block = _BLOCKS[kind][name]
            yield Token(Kind.BEGIN, block)
            yield from _triangle(child) if block == "COVARIANCE" else _inside(child, kind, depth + 1, turn)
            yield Token(Kind.END, block)
        elif len(child):
            yield from _inside(child, kind, depth + 1, turn)
        else:
            yield Token(Kind.KEY, name, (child.text or "").strip(), child.get("units", ""))


def _leaves(element: Element) -> dict[str, str]:
    found: dict[str, str] = {}
    for child in element.iter():
        if child is not element and not len(child) and _name(child) != "COMMENT":
            name, text = _name(child), (child.text or "").strip()
            if name in found:
                raise invalid("file", f"{name} once in {_name(element)}", "it twice")
            if not text or len(text.split()) > 1:
                raise invalid("file", f"{name}: one value", text)
            units, expected = child.get("units"), _UNITS.get(name)
            if units and expected and units.lower() != expected:
                raise invalid("file", f"{name} in {expected}", units)
            found[name] = text
    return found


def _row(element: Element, names: tuple[str, ...]) -> Token:
    found = _leaves(element)
    missing = [name for name in names[:7] if name not in found]
    if missing:
        raise invalid("file", f"{missing[0]} in {_name(element)}", "none")
    return Token(Kind.ROW, value=" ".join(found[name] for name in names if name in found))


def _triangle(element: Element) -> Iterator[Token]:
    found = _leaves(element)
    for name in ("EPOCH", "COV_REF_FRAME"):
        if name in found:
            yield Token(Kind.KEY, name, found[name])
    at = 0
    for size in range(1, 7):
        names = TRIANGLE[at : at + size]
        if any(name not in found for name in names):
            raise invalid("file", f"the {len(TRIANGLE)} numbers of a covariance", sorted(found))
        yield Token(Kind.ROW, value=" ".join(found[name] for name in names))
        at += size
