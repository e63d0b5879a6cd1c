"""Access checks: the Host header, the key, the role that a call needs, and the rate.

Called once per request, before any other code, and without the database.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastapi import Request
from starlette._utils import get_route_path
from starlette.types import Scope

from safestart.errors import SafestartError, Unavailable
from safestart.runtime.access import LOCAL, Caller, Role
from safestart.runtime.settings import Settings
from safestart_service.access.hosts import Hosts, without_host
from safestart_service.access.keyring import Keyring
from safestart_service.access.nearness import from_this_machine
from safestart_service.access.rates import Buckets
from safestart_service.errors import Forbidden, RateLimited, Unauthorized

if TYPE_CHECKING:
    from safestart.store.records import ApiKey

Presented = tuple[bytes | None, bytes | None, bytes | None]
"""Host, Authorization and X-API-Key of a request."""

PUBLIC = frozenset(
    {"/", "/conformance", "/dashboard", "/docs", "/healthz", "/openapi.json", "/openapi-3.0.json", "/readyz"}
)
"""Answered without a key: what the service is, its health, and pages that hold no data and ask for the key."""
INSTANT = frozenset({"/go-no-go", "/go-no-go/proof", "/certificates"})
"""Computed from the request alone: a POST to these paths changes nothing."""
MOST_FAILURES_PER_S = 5.0
_LONGEST_KEY = 512
_READING = ("GET", "HEAD", "OPTIONS")
_COMPUTED = ("/execution", "/estimate")
REMEDY = "a key made with `safestart keys create`, as Authorization: Bearer KEY or X-API-Key: KEY"


def needed_role(method: str, path: str) -> Role | None:
    """The role that a call needs; None for public calls. Calls that are not known to only read need ``submit``.

    An execution that runs at once stores nothing; if it queues a job, :meth:`Access.require_submit` checks further.
    """
    if path in INSTANT:
        return Role.READ
    if path in PUBLIC or path.startswith(("/static/", "/dashboard/")):
        return None
    if path == "/admin" or path.startswith("/admin/"):
        return Role.ADMIN
    return Role.READ if method in _READING or path.endswith(_COMPUTED) else Role.SUBMIT


class Access:
    """The gate of one application."""

    def __init__(self, settings: Settings, keyring: Keyring) -> None:
        self._keyring = keyring
        self.hosts = Hosts(settings.allowed_hosts)
        self._requests = Buckets(settings.rate_per_s)
        self._submissions = Buckets(settings.submit_rate_per_s)
        self._failures = Buckets(MOST_FAILURES_PER_S)

    def refusal(self, scope: Scope, presented: Presented) -> SafestartError | None:
        """The reason to refuse this request, or None. Leaves the key in the scope for :func:`caller`."""
        host, authorization, api_key = presented
        refused = without_host(scope) if host is None else self.hosts.refusal(host)
        if refused is not None:
            return refused
        needed = needed_role(scope["method"], get_route_path(scope))
        if needed is None:
            return None
        if not self._keyring.required:
            return self._without_keys(scope, needed)
        key = self._keyring.check(presented_key(authorization, api_key))
        if key is None:
            return self._unauthorized(scope)
        scope["safestart.key"] = key
        if not self._requests.take(key.id):
            return _rate_limited("requests", self._requests.rate)
        if needed is Role.READ:  # every key may do this
            return None
        if not key.role.allows(needed):
            return _forbidden(key, needed)
        return self._too_many(key) if needed is Role.SUBMIT else None

    def still_passes(self, request: Request) -> bool:
        """False once the caller's access has ended: the key has ended, or keys are now required."""
        key: ApiKey | None = request.scope.get("safestart.key")
        return not self._keyring.required if key is None else self._keyring.in_force(key.id)

    def require_submit(self, request: Request) -> None:
        """Raise ``Forbidden`` or ``RateLimited`` unless the caller may queue a job."""
        key: ApiKey | None = request.scope.get("safestart.key")
        if key is None:  # open to callers on this machine
            return
        if not key.role.allows(Role.SUBMIT):
            raise _forbidden(key, Role.SUBMIT)
        refused = self._too_many(key)
        if refused is not None:
            raise refused

    def _too_many(self, key: ApiKey) -> SafestartError | None:
        if self._submissions.take(key.id):
            return None
        return _rate_limited("submissions and dismissals", self._submissions.rate)

    def _without_keys(self, scope: Scope, needed: Role) -> SafestartError | None:
        """No key was ever made: open to callers over loopback, except for administration."""
        if not self._keyring.known and get_route_path(scope) not in INSTANT | {"/metrics"}:
            return _unread(self._keyring)
        if not from_this_machine(scope):
            return Unauthorized(
                f"a request from another machine needs a key, and no key exists; required {REMEDY}",
                required=REMEDY,
            )
        if not LOCAL.role.allows(needed):
            return Unauthorized(f"administration always needs a key; required {REMEDY}", required=REMEDY)
        return None

    def _unauthorized(self, scope: Scope) -> SafestartError:
        client = scope.get("client")
        if not self._failures.take(client[0] if client else ""):
            return RateLimited(
                f"too many requests without a valid key; required at most {MOST_FAILURES_PER_S:g} per second"
            )
        return ended_key()


def _unread(keyring: Keyring) -> Unavailable:
    if keyring.begun:
        return Unavailable("the API keys cannot be read from the database", required="the database")
    required = "its lifespan, which a server enters (app.router.lifespan_context(app) where it is mounted)"
    return Unavailable(f"the application has not begun; required {required}", required=required)


def ended_key() -> Unauthorized:
    """One sentence for every reason, so that answers do not show which keys exist."""
    return Unauthorized(
        f"no key, or one that is unknown, expired or revoked; required {REMEDY}", required=REMEDY
    )


def presented_key(authorization: bytes | None, api_key: bytes | None) -> bytes:
    """The key in the headers; empty without one."""
    if authorization is None:
        return (api_key or b"")[:_LONGEST_KEY]
    scheme, _, rest = authorization[:_LONGEST_KEY].partition(b" ")
    return rest.strip() if scheme.lower() == b"bearer" else b""


def caller(request: Request) -> Caller:
    """The caller, for the audit log."""
    scope = request.scope
    client = scope.get("client")
    address = client[0] if client else None
    key: ApiKey | None = scope.get("safestart.key")
    request_id = scope.get("safestart.request_id")
    if key is None:
        return Caller(None, LOCAL.name, LOCAL.role, address, request_id)
    return Caller(key.id, key.name, key.role, address, request_id)


def caller_id(scope: Scope) -> str | None:
    """The id of the caller's key; None without one."""
    key: ApiKey | None = scope.get("safestart.key")
    return None if key is None else key.id


def require_own(by: Caller, submitter: str | None) -> None:
    """Raise ``Forbidden`` unless ``by`` submitted the job, is an administrator, or no keys are in use."""
    if by.key_id is None or by.role is Role.ADMIN or by.key_id == submitter:
        return
    raise Forbidden(
        "the job belongs to another key; required the key that submitted it, or one with role admin",
        field="jobID",
        required="the submitter's key, or role admin",
    )


def _forbidden(key: ApiKey, needed: Role) -> Forbidden:
    return Forbidden(
        f"key {key.id} has role {key.role.value}; required role {needed.value}",
        required=f"role {needed.value}",
        received=key.role.value,
    )


def _rate_limited(what: str, rate: float) -> RateLimited:
    return RateLimited(
        f"too many {what} with this key; required at most {rate:g} per second",
        required=f"{rate:g} per second",
    )
