"""What a running computation reports and asks: its progress, and whether to stop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from safestart.errors import Cancelled
from safestart.runtime.cache import EMPTY, Shelf


def _silent(done: float, total: float, message: str) -> None:
    """Report to nobody."""


def _never() -> bool:
    return False


@dataclass(frozen=True, slots=True)
class Context:
    """Passed to every process and engine.

    ``report(done, total, message)`` receives real work units (cells, time steps); ``cancelled()`` is polled;
    ``shelf`` may hold earlier results. The default context is silent, never cancelled, and has an empty shelf.
    """

    report: Callable[[float, float, str], None] = field(default=_silent)
    cancelled: Callable[[], bool] = field(default=_never)
    shelf: Shelf = EMPTY

    def step(self, done: float, total: float, message: str = "") -> None:
        """Report progress, and raise ``Cancelled`` if the job was dismissed."""
        if self.cancelled():
            raise Cancelled("the job was dismissed while it ran")
        self.report(done, total, message)

    def part(self, start: float, share: float, total: float, label: str) -> Context:
        """Context of a sub-task that covers ``share`` units of ``total``, beginning at ``start``."""

        def report(done: float, of: float, message: str) -> None:
            text = f"{label}: {message}" if message else label
            self.report(start + share * (done / of if of > 0 else 1.0), total, text)

        return Context(report, self.cancelled, self.shelf)
