"""What every checker of a missed-burn proof sees first: no case, no piece of time, no part of a drift is missing."""

from __future__ import annotations

from abc import ABC, abstractmethod

from flint import fmpq

from safestart.proofs.abort.statement import Asked, Event
from safestart.proofs.strict import ProofRejected


class Complete(ABC):
    """One statement under check."""

    def __init__(self, asked: Asked) -> None:
        self.asked = asked

    @abstractmethod
    def held(self, event: Event) -> None:
        """Check the distance that each cell of an event claims."""

    def check(self) -> int:
        """Check that no case is missing and all cells hold; returns the number of cells."""
        self._complete()
        cells = 0
        for event in self.asked.events:
            self._covered(event)
            self.held(event)
            cells += len(event.cells)
        return cells

    def _complete(self) -> None:
        """Check that every event of the statement has its case, and that the pieces of [0, tau] leave no gap."""
        asked = self.asked
        lasting = {"late": asked.late, "stuck": asked.stuck}
        found: dict[tuple[str, int], list[tuple[fmpq, fmpq]]] = {}
        for event in asked.events:
            found.setdefault((event.kind, event.burn), []).append((event.first, event.last))
        needed = [("start", -1)]
        for k in range(len(asked.times)):
            needed.append(("made", k))
            needed += [("partial", k)] * asked.partial + [("misdirected", k)] * (asked.misdirected > 0)
            needed += [(kind, k) for kind, length in lasting.items() if length > 0]
        for kind, burn in needed:
            spans = sorted(found.get((kind, burn), []))
            if not spans:
                raise ProofRejected(f"cases: required one for {kind}, burn {burn}")
            if kind in lasting:
                reached = fmpq(0)
                for first, last in spans:
                    if not first <= reached <= last or last > lasting[kind]:
                        raise ProofRejected(f"cases: {kind}, burn {burn}: the pieces must follow one another")
                    reached = last
                if reached != lasting[kind]:
                    raise ProofRejected(
                        f"cases: {kind}, burn {burn}: the pieces end before {float(lasting[kind])} s"
                    )

    def _covered(self, event: Event) -> None:
        """Check that the cells cover the drift."""
        duration = self.duration(event)
        reached = fmpq(0)
        for cell in sorted(event.cells):
            if cell[0] > reached:
                break
            reached = max(reached, cell[1])
        if reached < duration:
            raise ProofRejected(
                f"{event.kind}, burn {event.burn}: the cells end at {float(reached):.9g} s, required "
                f"{float(duration):.9g} s"
            )

    def duration(self, event: Event) -> fmpq:
        """Duration of a drift: the horizon, after a burn that ends late, and the wait for the next, late one."""
        asked, k = self.asked, event.burn
        if event.kind == "start":
            return max(asked.horizon, asked.late)
        if event.kind == "made" and k + 1 < len(asked.times):
            return max(asked.horizon, asked.times[k + 1] - asked.times[k] + asked.late)
        return asked.horizon + event.last
