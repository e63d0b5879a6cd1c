"""Event streams and long polls: each queries the database repeatedly until its client leaves."""

from __future__ import annotations

import asyncio
import math
from time import monotonic
from typing import Any

from fastapi import Request
from fastapi.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from safestart_service.access.callers import Callers
from safestart_service.access.gate import Access

POLL_S = 0.25
UNSLOWED = 40


class Following(Callers):
    """The clients that follow jobs."""

    def __init__(self, most: int, access: Access) -> None:
        super().__init__("event streams and long polls", most)
        self._access = access

    @property
    def pause_s(self) -> float:
        """Time between queries: it grows with the number of followers, so that their total rate stays the same."""
        return POLL_S * max(1.0, self.now / UNSLOWED)

    async def pause(self, request: Request, most_s: float = math.inf) -> bool:
        """Wait that long, at most ``most_s``; False, within :data:`POLL_S`, once the caller's access has ended."""
        until = monotonic() + min(self.pause_s, most_s)
        while (left := until - monotonic()) > 0:
            if not self._access.still_passes(request):
                return False
            await asyncio.sleep(min(left, POLL_S))
        return self._access.still_passes(request)


class Followed(StreamingResponse):
    """A stream that holds a place from before its first byte until it ends for any reason."""

    def __init__(self, following: Following, request: Request, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._following = following
        self._name = following.enter(request)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the stream."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._following.leave(self._name)
