"""Answers computed while the client waits, beside the event loop: few at once, and so many in line."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from fastapi import Request

from safestart_service.access.callers import Callers
from safestart_service.state import services

Asked = ParamSpec("Asked")
Answer = TypeVar("Answer")


async def computed(
    request: Request, work: Callable[Asked, Answer], *args: Asked.args, **kwargs: Asked.kwargs
) -> Answer:
    """Do the work in a thread; raises ``RateLimited`` where too much is in line.

    What is in line is done even if its client has left, so a caller could fill the line for hours.
    """
    line: Callers = services(request).computing
    with line.place(request):
        return await asyncio.to_thread(work, *args, **kwargs)
