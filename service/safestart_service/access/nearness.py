"""Whether a caller is on this machine, by the socket's address and the proxy headers."""

from __future__ import annotations

import ipaddress
import re
from collections.abc import Iterable
from enum import Enum, auto
from functools import lru_cache

from starlette.types import Scope

_CLIENT = re.compile(
    r"forward(ed)?-for|coming-from|^x-client$|tunnel-client|(client|connecting|real|remote|originating|user|source|peer)-?ip|remote-addr"
    r"|envoy-external-address|cf-pseudo-ipv4"
)
"""In the names of header fields in which proxies name their clients, as a list of addresses."""
_FORWARDED = re.compile(r"(x-)?forwarded")
"""The names of fields that do so in the form of RFC 7239."""
_PASSED_ON = re.compile(
    r"(via|cdn-loop|x-varnish|surrogate-capability)|(cf|fastly|fly|incap|akamai|ali|eagleeye|x-amz-cf|x-amzn|x-azure|x-akamai|x-appengine"
    r"|x-cloud-trace|x-fastly|x-fd|x-sucuri|x-vercel|x-nf|x-goog)-.*"
)
"""The names of fields that say that a proxy passed the request on, for nobody knows whom."""
_NO_CLIENT = re.compile(r"(x-)?forwarded-.*|x-envoy-.*|x-original-.*|x-real-port|.*proxy.*")
"""The names of fields of a proxy that must name its client in another one."""
_LINKS = frozenset({"x-forwarded-proto", "x-forwarded-host", "x-forwarded-prefix"})
"""They say where a service is, and whoever makes links for a place of its own may say so; names of hosts are checked
against ``allowed_hosts``."""


class Says(Enum):
    """What a header field says about who asks."""

    NOTHING = auto()
    ADDRESSES = auto()
    ELEMENTS = auto()
    PROXY = auto()
    PROXY_OF_A_STRANGER = auto()


_FOR = re.compile(r'[ \t]*for[ \t]*=[ \t]*(?:"([^"\\]*)"|([^\s",;=]*))[ \t]*', re.IGNORECASE)
_SPACE = " \t"
MAX_PORT = 65_535
_ELEMENTS = re.compile(r'((?:[^,;"]|"[^"]*")*)([,;]|$)')
_HOST_PORT = re.compile(r"\[([^\]]*)\](?::(\d{1,5}))?|([^:]*):(\d{1,5})", re.ASCII)


def from_this_machine(scope: Scope) -> bool:
    """True when both ends are on this machine and no proxy forwards for a client elsewhere.

    Anything but a loopback address counts as elsewhere: an unknown or hidden client, a name, an empty element; so does
    a proxy that names no client.
    """
    client, server = scope.get("client"), scope.get("server")
    if server is not None and server[1] is None:  # a Unix socket: both ends are on this machine
        near = client is None or not client[0] or is_local(client[0])
    else:
        near = all(end is not None and is_local(end[0]) for end in (client, server))
    return near and _all_local(scope["headers"])


@lru_cache(64)
def is_local(address: str) -> bool:
    """True only for a loopback address; one with a zone is none."""
    if "%" in address:
        return False
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return False
    mapped = found.ipv4_mapped if isinstance(found, ipaddress.IPv6Address) else None
    return (mapped or found).is_loopback


def _all_local(headers: Iterable[tuple[bytes, bytes]]) -> bool:
    named = passed_on = False
    for name, value in headers:
        said = _says(name)
        if said is Says.NOTHING:
            continue
        if said is Says.PROXY_OF_A_STRANGER:
            return False
        if said is Says.PROXY:
            passed_on = True
            continue
        text = value.decode("latin-1")
        nodes = text.split(",") if said is Says.ADDRESSES else _nodes(text)
        if not all(is_local(without_port(node)) for node in nodes):
            return False
        named = True
    return named or not passed_on


@lru_cache(512)
def _says(field: bytes) -> Says:
    name = field.decode("latin-1").lower().replace("_", "-")  # some servers take both for the same
    if _CLIENT.search(name):
        return Says.ADDRESSES
    if _FORWARDED.fullmatch(name):
        return Says.ELEMENTS
    if _PASSED_ON.fullmatch(name):
        return Says.PROXY_OF_A_STRANGER
    if _NO_CLIENT.fullmatch(name) and name not in _LINKS:
        return Says.PROXY
    return Says.NOTHING


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
        elif "=" not in match[1] and match[1].strip(_SPACE):
            return [*found, ""]  # no pair at all
        at = match.end()
        if match[2] != ";":
            found.append(node)
            node = ""
        if not match[2]:
            return found


def without_port(node: str) -> str:
    """The address of a node of ``X-Forwarded-For`` or ``Forwarded``; the node itself where the port is none."""
    node = node.strip(_SPACE)
    match = _HOST_PORT.fullmatch(node)
    if match is None or int(match[2] or match[4] or 0) > MAX_PORT:
        return node
    return match[1] or match[3] or ""
