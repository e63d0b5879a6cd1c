"""Answers computed in threads while the client waits: few at the same time, and a limited line.

If the client has left, its answer is not computed: a page asks again with every move of a slider.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import TypeVar

from fastapi import Request
from starlette.requests import ClientDisconnect

from safestart.errors import Cancelled, SafestartError
from safestart.runtime.progress import Context
from safestart_service.access.callers import Callers
from safestart_service.state import services

Answer = TypeVar("Answer")


async def computed(request: Request, work: Callable[[Context], Answer]) -> Answer:
    """Do the work in a thread; raises ``RateLimited`` when the line is full, ``ClientDisconnect`` when the client
    left.

    The work's context reports cancellation once the client has left. Work in line is then not started; a running
    process polls its context, as it must, and ends early.
    """
    found = services(request)
    line: Callers = found.computing
    left = threading.Event()

    def wanted() -> Answer:
        if left.is_set():
            raise Cancelled("the caller left")
        return work(replace(found.context, cancelled=left.is_set))

    with line.place(request):
        watch = asyncio.create_task(_leaves(request, left))
        try:
            return await asyncio.to_thread(wanted)
        except Cancelled:
            raise ClientDisconnect from None
        finally:
            watch.cancel()


async def _leaves(request: Request, left: threading.Event) -> None:
    """Wait for the client to leave; the body must be read already or absent."""
    with suppress(SafestartError):  # an unused body
        while (await request.receive())["type"] != "http.disconnect":
            pass
        left.set()
