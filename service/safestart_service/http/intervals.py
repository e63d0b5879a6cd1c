"""Times and intervals in queries, as OGC API parameters have them."""

from __future__ import annotations

from datetime import UTC, datetime

from safestart.errors import invalid

_REQUIRED = "a time of RFC 3339 with its zone, or an interval FROM/TO with .. for an open end"


def interval(name: str, text: str | None) -> tuple[datetime | None, datetime | None]:
    """Both ends, None where open; a single time is both. Raises ``InvalidInput``."""
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
        # A + in a query that was not escaped arrives as a space; a time without zone could be any.
        if found.tzinfo is None or "T" not in part.upper():
            raise ValueError
        return found.astimezone(UTC)
    except (ValueError, OverflowError):
        raise invalid(name, _REQUIRED, text) from None


def without_nul(text: str) -> str:
    """Text that every database takes: PostgreSQL refuses NUL. Nothing has one, so it finds nothing either way."""
    return text.replace("\0", "\N{REPLACEMENT CHARACTER}")
