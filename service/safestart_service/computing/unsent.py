"""Long answers count as long as their clients have not taken them: whoever asks and does not read holds memory."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Iterable

from starlette.types import Message, Send

from safestart_service.computing.budget import Budget, Share
from safestart_service.errors import Busy

LONG_DIGITS = 6
"""An answer whose length has so many digits is long: all connections together hold less than 100 kB each without."""
PIECE = 262_144


class Unsent:
    """The way of one long answer to its client.

    A body that comes whole is in memory. It is sent piece by piece, each when the client has taken the one before, and
    ``share`` holds its length; where that has no room ``refuse`` answers in its place. One that comes in pieces has
    been counted by whoever makes them, or lies in memory for everybody.
    """

    def __init__(self, share: Share, send: Send, refuse: Callable[[], Awaitable[None]]) -> None:
        self._share, self._send, self._refuse = share, send, refuse
        self._start: Message | None = None
        self._refused = False

    async def __call__(self, message: Message) -> None:
        """Pass on a message of the application."""
        if message["type"] == "http.response.start":
            self._start = message  # until its body is there
            return
        if self._refused:
            return
        body, whole = message.get("body", b""), not message.get("more_body", False)
        if self._start is None:
            await self._send(message)
            return
        start, self._start = self._start, None
        if whole and not self._share.grow(len(body)):
            self._refused = True
            await self._refuse()
            return
        await self._send(start)
        if not whole:
            await self._send(message)
            return
        await send_pieces(self._send, body)


async def send_pieces(send: Send, body: bytes) -> None:
    """Send a body, each piece when the client has taken the one before."""
    for first in range(0, len(body), PIECE):
        await send({"type": "http.response.body", "body": body[first : first + PIECE], "more_body": True})
    await send({"type": "http.response.body", "body": b""})


def is_long(headers: Iterable[tuple[bytes, bytes]]) -> bool:
    """Whether the head of an answer announces a long body."""
    return any(len(value) >= LONG_DIGITS and name == b"content-length" for name, value in headers)


def full(budget: Budget) -> Busy:
    """The refusal of an answer that has no room."""
    required = f"at most {budget.most} bytes of long answers that their clients have not read yet"
    return Busy(
        f"long answers that are not read yet fill the memory for them; required {required}, half of them with one "
        "key",
        required=required,
    )
