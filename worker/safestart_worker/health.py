"""``python -m safestart_worker.health``: exit code 0 when a worker of this host sent a recent heartbeat."""

from __future__ import annotations

import socket
import sys

from safestart.errors import SafestartError
from safestart.runtime.logs import legible
from safestart.runtime.settings import settings
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository


def main() -> int:
    """Look for a heartbeat in the database."""
    try:
        owners = JobRepository(Database(settings().url())).owners_alive()
    except SafestartError as error:
        sys.stderr.write(f"{legible(error.detail)}\n")
        return 1
    return 0 if any(owner.startswith(f"{socket.gethostname()}-") for owner in owners) else 1


if __name__ == "__main__":
    sys.exit(main())
