"""What a PostgreSQL session of ours is set to, whatever its database, its role and the user's environment say.

``ALTER DATABASE``, ``ALTER ROLE`` and libpq's variables may set a form of dates that the driver cannot read, a coding
that has no letter for a name, or numbers cut to 15 digits. A ``SET`` after the connection stands above all of them.
What it does not name stays as the URL, the database or the role say: their ``search_path`` is a place for our tables.
"""

from __future__ import annotations

from typing import Any

from safestart.store.patient import STATEMENT_S

STOPPED_S = 10.0

CONNECTION = {
    # Keepalives detect a server that vanished; without them libpq waits for ever.
    "connect_timeout": 10,
    "tcp_user_timeout": 30_000,
    "keepalives_idle": 10,
    "keepalives_interval": 5,
    # Stated, as libpq would take them from the environment; our processes drop its variables, other programs keep them.
    "client_encoding": "utf8",
    "options": "",
    "target_session_attrs": "any",
    "application_name": "safestart",
}
"""Options of libpq; one that the URL has is the URL's."""

_SESSION = {
    # What the driver reads and writes.
    "client_encoding": "'UTF8'",
    "datestyle": "'ISO, MDY'",
    "intervalstyle": "'postgres'",
    "timezone": "'UTC'",
    "extra_float_digits": "1",  # the shortest text that is the same double
    "bytea_output": "'hex'",
    "standard_conforming_strings": "on",
    # Our transactions are written for this level; a snapshot asks for its own.
    "default_transaction_isolation": "'read committed'",
    "statement_timeout": f"{int(STATEMENT_S * 1000)}",
    # A process stopped in the middle of a transaction would keep its rows locked, and nobody could take over.
    "idle_in_transaction_session_timeout": f"{int(STOPPED_S * 1000)}",
    # Every job was once accepted and running, and an index keeps those rows until a vacuum. A bitmap scan visits
    # all of them each time; a plain one marks what is gone and passes over it from then on.
    "enable_bitmapscan": "off",
}


def settle(connection: Any, lock_s: float) -> None:
    """Set a new connection's session, in one round trip; raises the driver's errors.

    ``lock_s`` bounds the wait for a foreign lock, which must not hang every request.
    """
    values = _SESSION | {"lock_timeout": f"{int(lock_s * 1000)}"}
    with connection.cursor() as cursor:
        cursor.execute("; ".join(f"SET {name} = {value}" for name, value in values.items()))
    connection.commit()
