"""Tokens of a message as XML (505.0-B-3): OEM, AEM, OPM, OCM."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from safestart.errors import invalid
from safestart.interchange.ccsds.tokens import Kind, Token, written
from safestart.interchange.ccsds.xml_form import STATE, TRIANGLE

_HEADER = ("CREATION_DATE", "ORIGINATOR")
_META = ("OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "TIME_SYSTEM")


def text_of(tokens: Iterable[Token]) -> str:
    """The XML text of an OEM, AEM, OPM or OCM; raises ``InvalidInput`` for another kind."""
    first, *rest = map(written, tokens)
    kind = first.name.split("_")[1].lower()
    writers = {"oem": _oem, "aem": _aem, "opm": _opm, "ocm": _ocm}
    if kind not in writers:
        raise invalid("format", "KVN, or XML of OEM, AEM, OPM, OCM", f"XML of {kind.upper()}")
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    lines.append(f'<{kind} id="{first.name}" version="{first.value}">')
    header = [token for token in rest if token.name in _HEADER]
    lines += ["<header>", *map(_leaf, header), "</header>", "<body>"]
    lines += writers[kind]([token for token in rest if token not in header])
    return "\n".join([*lines, "</body>", f"</{kind}>"]) + "\n"


def _leaf(token: Token) -> str:
    units = f' units="{escape(token.units)}"' if token.units else ""
    return f"<{token.name}{units}>{escape(token.value, quote=False)}</{token.name}>"


def _segments(tokens: list[Token]) -> list[list[Token]]:
    starts = [k for k, token in enumerate(tokens) if token.kind is Kind.BEGIN and token.name == "META"]
    return [tokens[k:end] for k, end in zip(starts, [*starts[1:], len(tokens)], strict=True)]


def _oem(tokens: list[Token]) -> list[str]:
    lines = []
    for segment in _segments(tokens):
        lines += ["<segment>", "<metadata>"]
        within, rows = "META", iter(TRIANGLE)
        for token in segment:
            if token.kind is Kind.END:
                lines += ["</metadata>", "<data>"] if token.name == "META" else ["</covarianceMatrix>"]
                within = ""
            elif token.kind is Kind.BEGIN and token.name == "COVARIANCE":
                lines.append("<covarianceMatrix>")
                within, rows = "COVARIANCE", iter(TRIANGLE)
            elif token.kind is Kind.KEY:
                lines.append(_leaf(token))
            elif token.kind is Kind.ROW:
                values = token.value.split()
                if within:
                    lines += [_entry(next(rows), value) for value in values]
                else:
                    entries = "".join(_entry(name, value) for name, value in zip(STATE, values, strict=False))
                    lines.append(f"<stateVector>{entries}</stateVector>")
        lines += ["</data>", "</segment>"]
    return lines


def _entry(name: str, value: str) -> str:
    return f"<{name}>{value}</{name}>"


def _aem(tokens: list[Token]) -> list[str]:
    lines = []
    for segment in _segments(tokens):
        lines += ["<segment>", "<metadata>", *(_leaf(token) for token in segment if token.kind is Kind.KEY)]
        lines += ["</metadata>", "<data>"]
        for token in segment:
            if token.kind is Kind.ROW:
                epoch, *turn = token.value.split()
                entries = "".join(
                    _entry(name, value) for name, value in zip(("Q1", "Q2", "Q3", "QC"), turn, strict=True)
                )
                lines.append(
                    f"<attitudeState><quaternionEphemeris>{_entry('EPOCH', epoch)}<quaternion>{entries}</quaternion>"
                    "</quaternionEphemeris></attitudeState>"
                )
        lines += ["</data>", "</segment>"]
    return lines


def _opm(tokens: list[Token]) -> list[str]:
    lines = [
        "<segment>",
        "<metadata>",
        *(_leaf(token) for token in tokens if token.name in _META),
        "</metadata>",
        "<data>",
    ]
    groups: list[tuple[str, list[Token]]] = []
    for token in tokens:
        if token.name in _META:
            continue
        name = (
            "maneuverParameters"
            if token.name.startswith("MAN_")
            else "covarianceMatrix"
            if token.name.startswith(("COV_", "CX", "CY", "CZ"))
            else "stateVector"
        )
        if not groups or groups[-1][0] != name or token.name == "MAN_EPOCH_IGNITION":
            groups.append((name, []))
        groups[-1][1].append(token)
    for name, inside in groups:
        lines += [f"<{name}>", *map(_leaf, inside), f"</{name}>"]
    return [*lines, "</data>", "</segment>"]


def _ocm(tokens: list[Token]) -> list[str]:
    lines, name = ["<segment>"], ""
    for token in tokens:
        if token.kind is Kind.BEGIN:
            name = token.name.lower()
            lines.append("<metadata>" if name == "meta" else f"<{name}>")
        elif token.kind is Kind.END:
            lines += ["</metadata>", "<data>"] if name == "meta" else [f"</{name}>"]
        elif token.kind is Kind.KEY:
            lines.append(_leaf(token))
        else:
            lines.append(f"<{name}Line>{token.value}</{name}Line>")
    return [*lines, "</data>", "</segment>"]
