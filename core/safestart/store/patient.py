"""A PostgreSQL connection that limits how long it waits for an answer.

The server ends its own long statements. A stopped server process or a frozen volume cannot do that, and TCP does not
notice either while the kernel acknowledges packets. The client needs its own limit.
"""

from __future__ import annotations

from typing import Any

from psycopg import Connection, OperationalError

STATEMENT_S = 40.0
ANSWER_S = 45.0
"""Longer than the server's limit, so that the server's own error arrives first."""
MIGRATION_S = 7200.0


class PatientConnection(Connection[Any]):
    """A connection that closes itself when its server is silent for ``patience_s`` during a statement."""

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
