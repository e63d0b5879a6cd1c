"""Answers that nobody reads: what is sent waits in memory, on a connection that no other deadline ends."""

from __future__ import annotations

from asyncio import TimerHandle, Transport

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

UNREAD_S = 60.0
"""Who takes nothing of an answer for so long does not want it."""


class Read(HttpToolsProtocol):
    """A connection that is cut off when its peer takes nothing of what waits for it."""

    _unread: TimerHandle | None = None
    _waiting = 0

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override]
        """Be told of everything that is not taken at once."""
        super().connection_made(transport)
        transport.set_write_buffer_limits(high=0)

    def connection_lost(self, exc: Exception | None) -> None:
        """Expect nothing any more."""
        self._expect_nothing()
        super().connection_lost(exc)

    def pause_writing(self) -> None:
        """The peer does not take what we send; see whether it does later."""
        super().pause_writing()
        self._expect()

    def resume_writing(self) -> None:
        """It has taken everything."""
        super().resume_writing()
        self._expect_nothing()

    def _expect(self) -> None:
        self._waiting = self.transport.get_write_buffer_size()
        self._unread = self.loop.call_later(UNREAD_S, self._look)

    def _expect_nothing(self) -> None:
        if self._unread is not None:
            self._unread.cancel()
            self._unread = None

    def _look(self) -> None:
        if self.transport.get_write_buffer_size() < self._waiting:
            self._expect()
        else:
            self.transport.abort()
