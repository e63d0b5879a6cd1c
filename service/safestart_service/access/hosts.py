"""Which Host a request may name, in its own header and in what a proxy forwards."""

from __future__ import annotations

import ipaddress
import re
from functools import lru_cache

from starlette.types import Scope

from safestart.errors import SafestartError
from safestart_service.errors import MalformedRequest, Misdirected

_LONGEST = 260
_HOST_PORT = re.compile(r"(\[[0-9a-f:.]+(?:%[^\]]*)?\]|[a-z0-9._~!$&'()*+;=%-]+)(?::(\d{0,5}))?")


class Hosts:
    """The names of the setting ``allowed_hosts``, besides localhost and IP addresses."""

    def __init__(self, allowed: str) -> None:
        names = frozenset(name.strip().lower() for name in allowed.split(",")) - {""}
        self._refusal = lru_cache(1024)(lambda host, field: _refusal(host, field, names))

    def refusal(self, host: bytes, field: str = "Host") -> SafestartError | None:
        """Why a request that names this host is refused, or None."""
        return self._refusal(host[: 1 + _LONGEST], field)


def without_host(scope: Scope) -> SafestartError | None:
    """HTTP/1.0 has no Host header; from HTTP/1.1 on every request has one."""
    if scope.get("http_version") == "1.0":
        return None
    return _malformed("Host", "one, as the request is not HTTP/1.0", None)


def _refusal(host: bytes, field: str, names: frozenset[str]) -> SafestartError | None:
    """A foreign name server cannot rebind addresses and localhost; other names must be configured."""
    shown = host[:100].decode("latin-1")
    match = _HOST_PORT.fullmatch(host.decode("latin-1").lower())
    if match is None or len(host) > _LONGEST or int(match[2] or 0) > 65535:
        return _malformed(field, "a host and a port, once", shown)
    name = match[1]
    if name in names or name == "localhost" or name.endswith(".localhost"):
        return None
    bracketed = name.startswith("[")
    try:
        address = ipaddress.ip_address(name[1:-1] if bracketed else name)
    except ValueError:
        if bracketed:
            return _malformed(field, "an IPv6 address in brackets", shown)
        required = "localhost, an IP address, or a name in the setting allowed_hosts"
        return Misdirected(
            f"{field}: required {required}, received {shown!r}",
            field=field,
            required=required,
            received=shown,
        )
    if bracketed and address.version == 4:
        return _malformed(field, "an IPv6 address in brackets", shown)
    return None


def _malformed(field: str, required: str, received: str | None) -> MalformedRequest:
    shown = "none" if received is None else repr(received)
    return MalformedRequest(
        f"{field}: required {required} (RFC 9112), received {shown}",
        field=field,
        required=required,
        received=received,
    )
