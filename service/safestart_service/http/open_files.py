"""Each connection is an open file, and the system limits how many a process may have."""

from __future__ import annotations

import sys

from safestart.errors import InvalidInput

SPARE = 224
"""For the database, the event loop and connections being refused."""


def make_room(connections: int) -> None:
    """Raise this process's limit if it is too low; raises ``InvalidInput`` when the system does not allow enough."""
    if sys.platform == "win32":
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    needed = connections + SPARE
    if soft == resource.RLIM_INFINITY or soft >= needed:
        return
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (needed, hard))
    except (ValueError, OSError):
        required = f"at most {hard - SPARE}, as this process may open {hard} files"
        if hard <= SPARE:
            required = f"a system that lets this process open {needed} files, not {hard} (ulimit -n)"
        raise InvalidInput(
            f"max_connections: required {required}, received {connections}",
            field="max_connections",
            required=required,
            received=connections,
        ) from None
