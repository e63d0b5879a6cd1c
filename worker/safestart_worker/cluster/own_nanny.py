"""Dask's guard of a task process, for users whose files of Dask's are broken: the process does not look for them."""

from __future__ import annotations

import os
from typing import Any

from distributed import Nanny, Status

from safestart_worker.cluster.own_files import nowhere


class OwnNanny(Nanny):
    """While its process starts, this one has no home directory either; the process gets it back before it computes."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        if "HOME" in os.environ:
            self.env = {**self.env, "HOME": _HOME}

    async def instantiate(self) -> Status:
        """Start the process."""
        with nowhere():
            return await super().instantiate()


_HOME = os.path.expanduser("~")  # at import, when no process starts
