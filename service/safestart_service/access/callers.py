"""Limits on costly calls: a fixed number of a kind at the same time, of which one key may have half."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from fastapi import Request

from safestart.runtime.children.forks import Forkable
from safestart_service.access.gate import caller
from safestart_service.errors import RateLimited
from safestart_service.http.places import Places


class Callers(Forkable):
    """Places for one kind of call; refusals call it ``what``."""

    def __init__(self, what: str, most: int) -> None:
        self._what = what
        self._places = Places(most)
        self.tell_of_forks()

    @property
    def now(self) -> int:
        """The number of places."""
        return self._places.taken

    def enter(self, request: Request) -> str | None:
        """Take a place; returns the name under which to give it back. Raises ``RateLimited``."""
        name = caller(request).key_id
        if self._places.take(name):
            return name
        required = f"at most {self._places.most} at once, {self._places.share} of them with one key"
        raise RateLimited(f"too many {self._what}; required {required}", required=required)

    def forked(self) -> None:
        """Nobody is being served here."""
        self._places = Places(self._places.most)

    def leave(self, name: str | None) -> None:
        """Give a place back."""
        self._places.leave(name)

    @contextmanager
    def place(self, request: Request) -> Iterator[None]:
        """A place for as long as the block runs; raises ``RateLimited``."""
        name = self.enter(request)
        try:
            yield
        finally:
            self.leave(name)
