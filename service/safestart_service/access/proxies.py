"""Below a path and behind proxies: what trusted ones say about the client, the scheme, the host and the path.

A request that comes from a trusted address may say these with ``X-Forwarded-For``, ``-Proto``, ``-Host`` and
``-Prefix``; anyone else's are not read. All links follow from the scope, which this module corrects before anything
else reads it. What a trusted proxy passes on may still be a stranger's, so it is checked: a path has no place for
another host, and a host must be one that the service accepts.
"""

from __future__ import annotations

import ipaddress
from collections.abc import Container
from functools import lru_cache

from starlette.types import Scope

from safestart.errors import SafestartError, invalid
from safestart.runtime.settings import PATH_RULE, Network, Settings, networks, path_below
from safestart_service.access.hosts import Hosts
from safestart_service.access.nearness import is_local, without_port
from safestart_service.errors import MalformedRequest

_FOR, _PROTO, _HOST, _PREFIX = (
    b"x-forwarded-for",
    b"x-forwarded-proto",
    b"x-forwarded-host",
    b"x-forwarded-prefix",
)
FIELDS = frozenset({_FOR, _PROTO, _HOST, _PREFIX})
_SHOWN = {
    _PROTO: "X-Forwarded-Proto",
    _HOST: "X-Forwarded-Host",
    _PREFIX: "X-Forwarded-Prefix",
}
HOST = "safestart.host"
"""In the scope: the host that a trusted proxy names."""


class Proxies:
    """The settings ``root_path`` and ``trusted_proxies``; ``own`` are the first parts of our own paths.

    Raises ``InvalidInput`` for a root path that begins like one of ours: /jobs/x would be ambiguous below /jobs.
    """

    def __init__(self, settings: Settings, hosts: Hosts, own: Container[str] = ()) -> None:
        self.root = settings.root_path
        self._hosts = hosts
        self._own = own
        self._trusted = networks(settings.trusted_proxies)
        self._trusts = lru_cache(1024)(self._is_trusted)
        if self._is_own(self.root):
            raise invalid("settings.root_path", "a path that begins unlike the service's own", self.root)

    def place(self, scope: Scope) -> SafestartError | None:
        """Set client, scheme, host, root path and path of the scope as clients see them; the reason to refuse it."""
        said = self._said(scope)
        try:
            root = self._prefix(said) if _PREFIX in said else self.root
            scheme = _scheme(said)
        except MalformedRequest as error:
            return error
        host = said.get(_HOST)
        if host is not None:
            value = host[0] if len(host) == 1 else b", ".join(host)
            refused = self._hosts.refusal(value, _SHOWN[_HOST])
            if refused is not None:
                return refused
            scope[HOST] = value.decode("latin-1")
        if scheme is not None:
            scope["scheme"] = scheme
        if _FOR in said:
            self._name_client(scope, b",".join(said[_FOR]).decode("latin-1"))
        if root:
            _move(scope, root)
        return None

    def _said(self, scope: Scope) -> dict[bytes, list[bytes]]:
        peer, server = scope.get("client"), scope.get("server")
        address = peer[0] if peer else ""
        if not address and server is not None and server[1] is None:  # a Unix socket: someone on this machine
            address = "127.0.0.1"
        said: dict[bytes, list[bytes]] = {}
        if self._trusts(address):
            for name, value in scope["headers"]:
                if name in FIELDS:
                    said.setdefault(name, []).append(value)
        return said

    def _is_trusted(self, address: str) -> bool:
        found = _address(address)
        return found is not None and any(found in network for network in self._trusted_of(found.version))

    def _trusted_of(self, version: int) -> list[Network]:
        return [network for network in self._trusted if network.version == version]

    def _prefix(self, said: dict[bytes, list[bytes]]) -> str:
        text = _once(said, _PREFIX, PATH_RULE)
        try:
            root = path_below(text)
        except ValueError:
            raise _wrong(_PREFIX, PATH_RULE, text) from None
        if self._is_own(root):
            raise _wrong(_PREFIX, "a path that begins unlike the service's own", text)
        return root

    def _is_own(self, root: str) -> bool:
        return bool(root) and root.split("/")[1] in self._own

    def _name_client(self, scope: Scope, chain: str) -> None:
        """The last address that is not a trusted proxy, else the first; an unreadable one names nobody.

        Nobody from elsewhere becomes local by what a header says.
        """
        nodes = [without_port(node) for node in chain.split(",")]
        node = next((node for node in reversed(nodes) if not self._trusts(node)), nodes[0])
        peer = scope.get("client")
        if _address(node) is not None and (not is_local(node) or (peer is not None and is_local(peer[0]))):
            scope["client"] = (node, 0)


def _move(scope: Scope, root: str) -> None:
    """Put the application below ``root``, whether the proxy took it off the path or not."""
    path = scope["path"]
    if path == root:
        scope["path"] = f"{root}/"
    elif not path.startswith(f"{root}/"):
        scope["path"] = root + path
    scope["root_path"] = root + scope.get("root_path", "")


def _scheme(said: dict[bytes, list[bytes]]) -> str | None:
    if _PROTO not in said:
        return None
    text = _once(said, _PROTO, "http or https")
    scheme = text.strip().lower()
    if scheme not in ("http", "https"):
        raise _wrong(_PROTO, "http or https", text)
    return scheme


def _once(said: dict[bytes, list[bytes]], name: bytes, required: str) -> str:
    values = [value.decode("latin-1") for value in said[name]]
    if len(values) > 1:
        raise _wrong(name, f"{required}, once", ", ".join(values))
    return values[0]


def _wrong(name: bytes, required: str, received: str) -> MalformedRequest:
    field, shown = _SHOWN[name], received[:100]
    return MalformedRequest(
        f"{field}: required {required}; received {shown!r}", field=field, required=required, received=shown
    )


def _address(text: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        found = ipaddress.ip_address(text.partition("%")[0])
    except ValueError:
        return None
    mapped = found.ipv4_mapped if isinstance(found, ipaddress.IPv6Address) else None
    return mapped or found
