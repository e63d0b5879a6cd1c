"""The header fields that count before any route: what comes once comes once, and a list is all its lines.

Of two lines of one field, one layer would use the first and another the last (RFC 9110, 5.3).
"""

from __future__ import annotations

from starlette.types import Scope

from safestart.errors import SafestartError
from safestart_service.access.proxies import FIELDS
from safestart_service.errors import MalformedRequest, UnknownCoding

_ONCE = {
    name.lower().encode(): name
    for name in (
        *("Host", "Content-Length", "Content-Type", "Authorization", "X-API-Key"),
        *("Idempotency-Key", "Last-Event-ID"),
    )
}
_CODING = b"transfer-encoding"
_ID = b"x-request-id"
_READ = frozenset({*_ONCE, *FIELDS, _CODING, _ID})


def read(scope: Scope) -> tuple[dict[bytes, bytes], SafestartError | None]:
    """The header fields that the outermost layer reads, and why it refuses a repeated one or the body's coding.

    Of :data:`FIELDS` only the names count here; :mod:`safestart_service.access.proxies` reads all their lines.
    """
    found: dict[bytes, bytes] = {}
    refusal: SafestartError | None = None
    for name, value in scope["headers"]:
        if name in _READ:
            if name in found:
                if name in _ONCE:
                    shown = _ONCE[name]
                    refusal = MalformedRequest(
                        f"{shown}: required once, received twice", field=shown, required="once"
                    )
                elif name == _CODING:
                    value = found[name] + b", " + value
                elif name == _ID:  # nobody knows which of them is meant: it gets one of ours
                    value = b""
            found[name] = value
    if _CODING in found and refusal is None:
        refusal = _coded(scope, found[_CODING])
    return found, refusal


def _coded(scope: Scope, coding: bytes) -> SafestartError | None:
    """Why a body in this transfer coding is refused, or None: the server undoes the last coding, chunked, alone."""
    shown = coding[:100].decode("latin-1")
    if (
        scope.get("http_version") == "1.0"
    ):  # RFC 9112, 6.1: what a proxy of that age takes for the body is unknown
        required = "none in HTTP/1.0"
        return MalformedRequest(
            f"Transfer-Encoding: required {required}, received {shown!r}",
            field="Transfer-Encoding",
            required=required,
            received=shown,
        )
    codings = [part.strip().lower() for part in coding.split(b",")]
    if [part for part in codings if part] == [b"chunked"]:
        return None
    return UnknownCoding(
        f"Transfer-Encoding: required chunked alone, received {shown!r}",
        field="Transfer-Encoding",
        required="chunked",
        received=shown,
    )
