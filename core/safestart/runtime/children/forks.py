"""What a process must not share with those that it forks: connections, threads, the places of who is being served.

A program may make an application, use it, and fork then. What the child inherited speaks to the parent's helpers and
database, or waits for threads that are the parent's alone.
"""

from __future__ import annotations

import os
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


def _before() -> None:
    for one in list(_TOLD):
        one.forking()


def _in_child() -> None:
    for one in list(_TOLD):
        one.forked()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_before, after_in_child=_in_child)
