"""Event streams and long polls: each asks the database again and again for as long as its client likes."""

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
    """Those who follow a job."""

    def __init__(self, most: int, access: Access) -> None:
        super().__init__("event streams and long polls", most)
        self._access = access

    @property
    def pause_s(self) -> float:
        """How long to wait before asking again: the more follow, the longer, so that all together ask no more often."""
        return POLL_S * max(1.0, self.now / UNSLOWED)

    async def pause(self, request: Request, most_s: float = math.inf) -> bool:
        """Wait that long, ``most_s`` at most; False, within :data:`POLL_S`, when the caller may not follow any more."""
        until = monotonic() + min(self.pause_s, most_s)
        while (left := until - monotonic()) > 0:
            if not self._access.still_passes(request):
                return False
            await asyncio.sleep(min(left, POLL_S))
        return self._access.still_passes(request)


class Followed(StreamingResponse):
    """A stream that holds a place from before its first byte until its end, however it ends."""

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
