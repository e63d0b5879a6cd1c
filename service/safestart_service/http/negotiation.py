"""Which of the offered media types a caller accepts (RFC 9110, 12.5.1)."""

from __future__ import annotations

from collections.abc import Sequence

from safestart_service.errors import NotAcceptable


def chosen(accept: str | None, offered: Sequence[str]) -> str:
    """The best of ``offered``; the first of several equally good ones. Raises ``NotAcceptable``."""
    if not accept:
        return offered[0]
    ranges = [_range(part) for part in accept.split(",") if part.strip()]
    ranked = [(_quality(kind, ranges), -place, kind) for place, kind in enumerate(offered)]
    (quality, _), _, best = max(ranked)
    if quality <= 0.0:
        there_are = ", ".join(offered)
        raise NotAcceptable(
            f"Accept: required one of {there_are}, received {accept[:200]!r}",
            field="Accept",
            required=f"one of {there_are}",
            received=accept,
        )
    return best


def _range(part: str) -> tuple[str, float]:
    kind, *parameters = (piece.strip().lower() for piece in part.split(";"))
    quality = 1.0
    for parameter in parameters:
        if parameter.startswith("q="):
            try:
                quality = min(max(float(parameter[2:]), 0.0), 1.0)
            except ValueError:
                quality = 0.0
    return kind, quality


def _quality(kind: str, ranges: Sequence[tuple[str, float]]) -> tuple[float, int]:
    """Quality by the most specific range that includes the type, and how specific that range is."""
    best = (0.0, 0)
    for specificity, wanted in enumerate(("*/*", kind.partition("/")[0] + "/*", kind), start=1):
        for name, quality in ranges:
            if name == wanted:
                best = (quality, specificity)
    return best
