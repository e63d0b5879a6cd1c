"""Whether a caller is on this machine, by the socket's address and the proxy headers."""

from __future__ import annotations

import ipaddress
import re
from functools import lru_cache

from starlette.types import Scope

SPEAKS_FOR = frozenset(
    {
        b"x-forwarded-for",
        b"x-real-ip",
        b"x-client-ip",
        b"x-cluster-client-ip",
        b"x-original-forwarded-for",
        b"cf-connecting-ip",
        b"true-client-ip",
        b"fastly-client-ip",
        b"fly-client-ip",
        b"forwarded-for",
        b"x-forwarded-client-ip",
        b"client-ip",
        b"x-remote-ip",
        b"x-remote-addr",
        b"x-originating-ip",
        b"x-azure-clientip",
        b"x-envoy-external-address",
        b"x-appengine-user-ip",
        b"cf-connecting-ipv6",
        b"cf-pseudo-ipv4",
    }
)
"""Header fields in which proxies name their clients, as a list of addresses."""
FORWARDED = frozenset({b"forwarded", b"x-forwarded"})
PASSED_ON = frozenset({b"via", b"cdn-loop"})
"""Header fields that say that a proxy passed the request on, for nobody knows whom."""
_FOR = re.compile(r'\s*for\s*=\s*(?:"([^"\\]*)"|([^\s",;=]*))\s*', re.IGNORECASE)
_ELEMENTS = re.compile(r'((?:[^,;"]|"[^"]*")*)([,;]|$)')
_HOST_PORT = re.compile(r"\[([^\]]*)\](?::\d{1,5})?|([^:]*):\d{1,5}")


def from_this_machine(scope: Scope) -> bool:
    """True when both ends are on this machine and no proxy forwards for a client elsewhere.

    Anything but a loopback address counts as elsewhere: an unknown or hidden client, a name, an empty element.
    """
    client, server = scope.get("client"), scope.get("server")
    if server is not None and server[1] is None:  # a Unix socket: both ends are on this machine
        near = client is None or not client[0] or is_local(client[0])
    else:
        near = all(end is not None and is_local(end[0]) for end in (client, server))
    return near and all(_only_local(name, value) for name, value in scope["headers"])


@lru_cache(64)
def is_local(address: str) -> bool:
    """True only for a loopback address."""
    try:
        found = ipaddress.ip_address(address.partition("%")[0])
    except ValueError:
        return False
    mapped = found.ipv4_mapped if isinstance(found, ipaddress.IPv6Address) else None
    return (mapped or found).is_loopback


def _only_local(name: bytes, value: bytes) -> bool:
    if name in SPEAKS_FOR:
        return all(is_local(without_port(part)) for part in value.decode("latin-1").split(","))
    if name in PASSED_ON:
        return False
    if name in FORWARDED:
        return all(is_local(without_port(node)) for node in _nodes(value.decode("latin-1")))
    return True


def _nodes(text: str) -> list[str]:
    """The client of each element of ``Forwarded`` (RFC 7239); "" for an element without a client or unreadable."""
    found: list[str] = []
    node, at = "", 0
    while True:
        match = _ELEMENTS.match(text, at)
        if match is None:  # an unterminated quote
            return [*found, ""]
        pair = _FOR.fullmatch(match[1])
        if pair is not None:
            node = "" if node else pair[1] or pair[2] or ""
        at = match.end()
        if match[2] != ";":
            found.append(node)
            node = ""
        if not match[2]:
            return found


def without_port(node: str) -> str:
    """The address of a node of ``X-Forwarded-For`` or ``Forwarded``."""
    node = node.strip()
    match = _HOST_PORT.fullmatch(node)
    return node if match is None else match[1] or match[2] or ""
