"""The database's password from a file: whoever may inspect the process sees its environment."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote

from safestart.errors import invalid

_REQUIRED = "a readable file that holds the password of the database"


def with_password(url: str, file: str) -> str:
    """``url`` with the password in ``file``, when it is one of PostgreSQL with a user and no password.

    Raises ``InvalidInput`` for a file that holds no password. Any other URL stays as it is: the store refuses what it
    cannot use.
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
        password = Path(file).read_text(encoding="utf-8").rstrip("\r\n")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else "no UTF-8 text"
        raise invalid("database_password_file", _REQUIRED, f"{file} ({reason})") from None
    if not password:
        raise invalid("database_password_file", _REQUIRED, f"{file} (empty)")
    return password
