"""The URL of the database: which URLs are accepted, and how to show one without its secrets."""

from __future__ import annotations

from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError

from safestart.errors import InvalidInput

REQUIRED = (
    "sqlite:///PATH of a file in an existing, writable directory, or postgresql://USER:PASSWORD@HOST/NAME"
)
_DRIVERS = {
    "sqlite": "sqlite",
    "sqlite+pysqlite": "sqlite",
    "postgresql": "postgresql+psycopg",
    "postgresql+psycopg": "postgresql+psycopg",
}
# Secret options of libpq.
_SECRETS = ("password", "sslpassword")
_HIDDEN = "***"


def parse(url: str) -> URL:
    """The URL with our driver; raises ``InvalidInput``, which repeats no password."""
    try:
        parsed = make_url(url)
    except (ArgumentError, ValueError):
        # An unparsable URL may contain a password, so the message does not repeat it.
        raise refused("something that is not a URL") from None
    if "@" in (parsed.host or ""):
        raise refused("one with two @ (in a user's name or a password it is written %40)")
    if parsed.drivername not in _DRIVERS:
        raise refused(shown(parsed))
    if parsed.port is not None and not 0 < parsed.port < 65536:
        raise refused(f"port {parsed.port}")
    parsed = parsed.set(drivername=_DRIVERS[parsed.drivername])
    if parsed.get_backend_name() == "sqlite" and parsed.database in (None, "", ":memory:"):
        raise refused("a SQLite database in memory, which service and worker could not share")
    if parsed.get_backend_name() == "sqlite" and "uri" in parsed.query:
        raise refused("a SQLite database by a URI")  # its file would be watched and backed up by a wrong path
    return parsed


def shown(url: URL) -> str:
    """The URL without its secrets."""
    hidden = {name: _HIDDEN for name in _SECRETS if name in url.query}
    text = url.update_query_dict(hidden).render_as_string(hide_password=True)
    return text.replace("=%2A%2A%2A", f"={_HIDDEN}")


def without_secrets(text: str, url: URL) -> str:
    """Another library's message about the database, without the secrets of its URL."""
    for secret in (url.password, *(url.query.get(name) for name in _SECRETS)):
        if secret:
            text = text.replace(str(secret), _HIDDEN)
    return text


def refused(received: str) -> InvalidInput:
    """The error for an invalid URL."""
    return InvalidInput(
        f"database_url: required {REQUIRED}, received {received}",
        field="database_url",
        required=REQUIRED,
        received=received,
    )
