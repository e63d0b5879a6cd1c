"""What a process must not share with those that it forks: connections, threads, the places of who is being served.

A program may make an application, use it, and fork then. What the child inherited speaks to the parent's helpers and
database, or waits for threads that are the parent's alone.
"""

from __future__ import annotations

import os
from threading import RLock
from types import TracebackType
from weakref import WeakSet


class Forkable:
    """Something that is made anew in a child, from the call of :meth:`tell_of_forks` on."""

    def tell_of_forks(self) -> None:
        """Have the methods below called."""
        _TOLD.add(self)

    def forking(self) -> None:
        """This process is about to fork, and lives on."""

    def forked(self) -> None:
        """This process is the child. Other threads are gone, and may have held any lock."""


_TOLD: WeakSet[Forkable] = WeakSet()


class ForkableLock(Forkable):
    """A lock that is free in a child, whichever thread of the parent held it; its own thread may take it again.

    What it guards must be whole at every moment, as a fork does not wait for the lock.
    """

    def __init__(self) -> None:
        self.forked()
        self.tell_of_forks()

    def forked(self) -> None:
        """Be free."""
        self._lock = RLock()

    def __enter__(self) -> None:
        self._lock.acquire()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._lock.release()


def _before() -> None:
    for one in list(_TOLD):
        one.forking()


def _in_child() -> None:
    for one in list(_TOLD):
        one.forked()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_before, after_in_child=_in_child)
