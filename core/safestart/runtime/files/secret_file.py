"""Read the database's password from a file, because anyone who may inspect the process sees its environment."""

from __future__ import annotations

from urllib.parse import quote

from safestart.errors import invalid
from safestart.runtime.files.bounded import bytes_within

_MOST_BYTES = 64 * 1024
_REQUIRED = "a readable file that holds the password of the database"


def with_password(url: str, file: str) -> str:
    """Add the password in ``file`` to ``url`` when this is a PostgreSQL URL with a user and no password.

    Raises ``InvalidInput`` for a file without a password. Any other URL is returned unchanged; the store refuses
    those it cannot use.
    """
    scheme, separator, rest = url.partition("://")
    user, at, place = rest.partition("@")
    if (
        not (file and separator and at)
        or scheme.partition("+")[0] != "postgresql"
        or ":" in user
        or "/" in user
    ):
        return url
    return f"{scheme}://{user}:{quote(_read(file), safe='')}@{place}"


def _read(file: str) -> str:
    try:
        password = bytes_within("database_password_file", file, _MOST_BYTES).decode().rstrip("\r\n")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else "no UTF-8 text"
        raise invalid("database_password_file", _REQUIRED, f"{file} ({reason})") from None
    if not password:
        raise invalid("database_password_file", _REQUIRED, f"{file} (empty)")
    return password
