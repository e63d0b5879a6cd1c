"""Times and intervals in queries, in the form of OGC API parameters."""

from __future__ import annotations

from datetime import UTC, datetime

from safestart.errors import invalid

_REQUIRED = "a time of RFC 3339 with its zone, or an interval FROM/TO with .. for an open end"


def interval(name: str, text: str | None) -> tuple[datetime | None, datetime | None]:
    """Both ends, None for an open end; a single time gives two equal ends. Raises ``InvalidInput``."""
    if text is None:
        return None, None
    parts = text.split("/")
    if len(parts) > 2:
        raise invalid(name, _REQUIRED, text)
    start, end = (_time(name, part, text) for part in (parts if len(parts) == 2 else parts * 2))
    if (start is None and end is None) or (start is not None and end is not None and start > end):
        raise invalid(name, _REQUIRED + ", not before its start", text)
    return start, end


def _time(name: str, part: str, text: str) -> datetime | None:
    if part in ("", "..") and "/" in text:
        return None
    try:
        found = datetime.fromisoformat(part.replace("t", "T").replace("z", "Z"))
        # An unescaped + in a query arrives as a space; a time without zone is ambiguous.
        if found.tzinfo is None or "T" not in part.upper():
            raise ValueError
        return found.astimezone(UTC)
    except (ValueError, OverflowError):
        raise invalid(name, _REQUIRED, text) from None


def without_nul(text: str) -> str:
    """Replace NUL, which PostgreSQL refuses; no stored text contains it, so a search still finds nothing."""
    return text.replace("\0", "\N{REPLACEMENT CHARACTER}")
