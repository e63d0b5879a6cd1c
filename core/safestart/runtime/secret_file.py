"""The database's password from a file: what stands in the environment is shown to whoever may inspect the process."""

from __future__ import annotations

from pathlib import Path

from safestart.errors import invalid

_REQUIRED = "a readable file that holds the password of the database"


def with_password(url: str, file: str) -> str:
    """``url`` with the password in ``file``, when it is one of PostgreSQL without any; raises ``InvalidInput``."""
    if not file:
        return url
    # Here and not above: whoever only reads settings starts without SQLAlchemy.
    from sqlalchemy.engine import make_url
    from sqlalchemy.exc import ArgumentError

    try:
        parsed = make_url(url)
    except (ArgumentError, ValueError):
        return url  # refused where it is used, by what a URL must be
    if parsed.get_backend_name() != "postgresql" or parsed.password is not None:
        return url
    return parsed.set(password=_read(file)).render_as_string(hide_password=False)


def _read(file: str) -> str:
    try:
        password = Path(file).read_text(encoding="utf-8").rstrip("\r\n")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else "no UTF-8 text"
        raise invalid("database_password_file", _REQUIRED, f"{file} ({reason})") from None
    if not password:
        raise invalid("database_password_file", _REQUIRED, f"{file} (empty)")
    return password
