"""Logs on stderr: one line per event, as text or as JSON, with its job or request.

A call names its job with ``extra=about(job=...)``; both formats show it.
"""

from __future__ import annotations

import json
import logging
from datetime import UTC, datetime
from typing import Any, Literal
from unicodedata import category

LogFormat = Literal["text", "json"]
_SUBJECTS = ("job", "request")
_LINES = frozenset({"Zl", "Zp"})


def about(**subjects: str) -> dict[str, Any]:
    """The subject of a log record: ``job`` and ``request`` ids."""
    return subjects


def configure(form: LogFormat) -> None:
    """Send warnings of every library and everything of ours to stderr, in this format."""
    lines = JsonLines() if form == "json" else TextLines()
    handler = logging.StreamHandler()
    handler.setFormatter(lines)
    logging.basicConfig(level=logging.WARNING, handlers=[handler], force=True)
    logging.getLogger("safestart").setLevel(logging.INFO)
    logging.captureWarnings(True)
    for logger in logging.root.manager.loggerDict.values():
        # Libraries with their own handlers (Dask) would keep them; readers of the log need one format.
        for own in logger.handlers if isinstance(logger, logging.Logger) else ():
            own.setFormatter(lines)


class TextLines(logging.Formatter):
    """``TIME LEVEL LOGGER job=ID MESSAGE``, times in UTC."""

    def format(self, record: logging.LogRecord) -> str:
        """The record as lines; a stack trace follows its message."""
        when = datetime.fromtimestamp(record.created, UTC).isoformat(sep=" ", timespec="milliseconds")
        parts = [when, record.levelname, record.name]
        parts += [f"{name}={value}" for name, value in _subjects(record).items()]
        parts.append(legible(record.getMessage()))
        trace = _trace(record)
        return " ".join(parts) + (f"\n{trace}" if trace else "")


class JsonLines(logging.Formatter):
    """One JSON object per line."""

    def format(self, record: logging.LogRecord) -> str:
        """The record as one line."""
        line: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(),
            "level": record.levelname.lower(),
            "logger": record.name,
            **_subjects(record),
            "message": record.getMessage(),
        }
        trace = _trace(record)
        return json.dumps(line | ({"trace": trace} if trace else {}), default=str)


def _subjects(record: logging.LogRecord) -> dict[str, str]:
    return {name: str(getattr(record, name)) for name in _SUBJECTS if getattr(record, name, None) is not None}


def legible(text: str, keep: str = "") -> str:
    r"""The text with ``\x1b`` for an escape, and so on; ``keep`` names those that stay.

    It can start no new line, send no control codes to a terminal, and reverse nothing that follows (bidirectional
    marks); halves of a surrogate pair would end the write.
    """
    if text.isprintable():
        return text
    return "".join(c if c in keep or not _hidden(c) else c.encode("unicode_escape").decode() for c in text)


def _hidden(c: str) -> bool:
    kind = category(c)
    return kind[0] == "C" or kind in _LINES


def _trace(record: logging.LogRecord) -> str:
    return logging.Formatter().formatException(record.exc_info) if record.exc_info else ""
