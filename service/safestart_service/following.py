"""Event streams and long polls: each asks the database again and again for as long as its client likes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from fastapi import Request
from fastapi.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from safestart_service.access import caller
from safestart_service.errors import RateLimited
from safestart_service.places import Places

POLL_S = 0.25
UNSLOWED = 40


class Following:
    """Places for those who follow a job, of which one key may hold half."""

    def __init__(self, most: int) -> None:
        self._places = Places(most)

    @property
    def pause_s(self) -> float:
        """How long to wait before asking again: the more follow, the longer, so that all together ask no more often."""
        return POLL_S * max(1.0, self._places.taken / UNSLOWED)

    def take(self, request: Request) -> str | None:
        """Take a place; returns the name to leave it under. Raises ``RateLimited``."""
        name = caller(request).key_id
        if self._places.take(name):
            return name
        required = f"at most {self._places.most} at once, {self._places.share} of them with one key"
        raise RateLimited(
            f"too many event streams and long polls are open; required {required}", required=required
        )

    def leave(self, name: str | None) -> None:
        """Give a place back."""
        self._places.leave(name)

    @contextmanager
    def place(self, request: Request) -> Iterator[None]:
        """A place for as long as the block runs; raises ``RateLimited``."""
        name = self.take(request)
        try:
            yield
        finally:
            self.leave(name)


class Followed(StreamingResponse):
    """A stream that holds a place from before its first byte until its end, however it ends."""

    def __init__(self, following: Following, request: Request, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._following = following
        self._name = following.take(request)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the stream."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._following.leave(self._name)
