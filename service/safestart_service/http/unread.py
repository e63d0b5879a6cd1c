"""Unread answers: they stay in memory, on a connection that no other deadline ends."""

from __future__ import annotations

from asyncio import TimerHandle, Transport

from safestart_service.http.offers import Offers

UNREAD_S = 60.0
"""A client that reads none of an answer for this long, s, has given up."""


class Read(Offers):
    """A connection that is cut when its peer reads none of the waiting data."""

    _unread: TimerHandle | None = None
    _waiting = 0

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override]
        """Ask asyncio to report all data that the peer does not take at once."""
        super().connection_made(transport)
        transport.set_write_buffer_limits(high=0)

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop watching."""
        self._expect_nothing()
        super().connection_lost(exc)

    def pause_writing(self) -> None:
        """The peer does not read our data; check later whether it does."""
        super().pause_writing()
        self._expect()

    def resume_writing(self) -> None:
        """The peer has read everything."""
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
