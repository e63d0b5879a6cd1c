"""A PostgreSQL connection that waits so long for an answer and no longer.

The server ends a statement that takes too long by itself. One that stands still (a stopped process, a frozen machine or
volume) does not, and TCP does not notice while its kernel acknowledges: only who asked can.
"""

from __future__ import annotations

from typing import Any

from psycopg import Connection, OperationalError

STATEMENT_S = 40.0
ANSWER_S = 45.0
"""Later than the server's own limit: then its words are heard."""
MIGRATION_S = 7200.0


class PatientConnection(Connection[Any]):
    """Closes itself when its server says nothing for ``patience_s`` in the middle of a statement."""

    patience_s = ANSWER_S

    def wait(self, gen: Any, interval: float = 0.1, timeout: float | None = None) -> Any:
        """Wait for the end of ``gen``; raises ``OperationalError``."""
        if timeout is not None:
            return super().wait(gen, interval, timeout)
        try:
            return super().wait(gen, interval, self.patience_s)
        except OperationalError as error:
            if type(error).__name__ != "_WaitTimeout":
                raise
            self.pgconn.finish()
            raise OperationalError(f"the server did not answer within {self.patience_s:g} s") from None
