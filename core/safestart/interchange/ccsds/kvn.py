"""KVN, the text form of CCSDS messages (502.0-B-3, 504.0-B-2, 508.0-B-1): lines of KEYWORD = value [units]."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from safestart.interchange.ccsds.tokens import Kind, Token, refused, written
from safestart.interchange.source import refuse_many_lines

_PAIR = re.compile(r"([A-Z][A-Z0-9_]*)\s*=\s*(.*?)\s*(?:\[([^\[\]]*)\])?", re.ASCII)
_MARK = re.compile(r"([A-Z][A-Z0-9_]*)_(START|STOP)", re.ASCII)
_ROW = re.compile(r"[-+.0-9][-+.:0-9A-Za-z]*(?:\s+\S+)*", re.ASCII)
_LONGEST_LINE = 4096
_MOST_LINES = 2_000_000


def tokens_of(text: str) -> Iterator[Token]:
    """The tokens of a KVN text; raises ``InvalidInput`` with the line of an invalid token."""
    refuse_many_lines(text, _MOST_LINES)
    for line, raw in enumerate(text.splitlines(), 1):
        if len(raw) > _LONGEST_LINE:
            raise refused(line, f"at most {_LONGEST_LINE} characters in a line", len(raw))
        content = raw.strip()
        if not content or content == "COMMENT" or content.startswith("COMMENT "):
            continue
        if content[0] not in "-+.0123456789":
            pair = _PAIR.fullmatch(content)
            if pair is not None:
                yield Token(Kind.KEY, pair[1], pair[2], (pair[3] or "").strip(), line)
                continue
            mark = _MARK.fullmatch(content)
            if mark is not None:
                yield Token(Kind.BEGIN if mark[2] == "START" else Kind.END, mark[1], line=line)
                continue
        elif _ROW.fullmatch(content):
            yield Token(Kind.ROW, value=content, line=line)
            continue
        raise refused(line, "KEYWORD = value, a block's START or STOP, or a row of data", content)


def text_of(tokens: Iterable[Token]) -> str:
    """The KVN text of tokens; raises ``InvalidInput`` for a text with a line end."""
    lines = []
    for token in map(written, tokens):
        if token.kind is Kind.KEY:
            lines.append(f"{token.name} = {token.value}" + (f" [{token.units}]" if token.units else ""))
        elif token.kind is Kind.ROW:
            lines.append(token.value)
        elif token.kind is Kind.BEGIN:
            lines += ["", f"{token.name}_START"]
        else:
            lines.append(f"{token.name}_STOP")
    return "\n".join(lines) + "\n"
