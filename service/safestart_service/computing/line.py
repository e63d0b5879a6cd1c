"""The line in front of the helper processes: fair among keys, with one slot that only quick answers may take."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

QUICK_S = 1.0


@dataclass(eq=False, slots=True)
class _Waiting:
    """``turn`` is done by :meth:`Line._serve`, or where whoever waits for it has left."""

    name: str | None
    quick: bool
    turn: asyncio.Future[None]


class Line:
    """``slots`` at once. A free slot goes to the name that holds the fewest slots, and among equals to the first.

    The last free slot is for quick answers: long ones alone never take all slots, unless there is one slot only.
    """

    def __init__(self, slots: int) -> None:
        self.slots = slots
        self._long_slots = max(1, slots - 1)
        self._waiting: list[_Waiting] = []
        self._held: Counter[str | None] = Counter()
        self._long = 0

    @asynccontextmanager
    async def slot(self, name: str | None, cost_s: float) -> AsyncIterator[None]:
        """Hold a slot for the block; ``cost_s`` is the expected duration."""
        entry = _Waiting(name, cost_s <= QUICK_S, asyncio.get_running_loop().create_future())
        self._waiting.append(entry)
        self._serve()
        try:
            await entry.turn
        except asyncio.CancelledError:
            if entry in self._waiting:
                self._waiting.remove(entry)
            else:
                self._leave(entry)
            raise
        try:
            yield
        finally:
            self._leave(entry)

    def _leave(self, entry: _Waiting) -> None:
        self._held[entry.name] -= 1
        self._long -= not entry.quick
        self._serve()

    def _serve(self) -> None:
        while self._held.total() < self.slots:
            # Who has left in this turn of the loop is still in line, until its own task goes on.
            waiting = [one for one in self._waiting if not one.turn.done()]
            able = [one for one in waiting if one.quick or self._long < self._long_slots]
            if not able:
                return
            entry = min(able, key=lambda one: self._held[one.name])
            self._waiting.remove(entry)
            self._held[entry.name] += 1
            self._long += not entry.quick
            entry.turn.set_result(None)
