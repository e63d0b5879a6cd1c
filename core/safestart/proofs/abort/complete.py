"""What every checker of a missed-burn proof sees first: no case, no piece of time, no part of a drift is missing."""

from __future__ import annotations

from abc import ABC, abstractmethod

from flint import fmpq

from safestart.proofs.abort.finite import window
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
        """Check that every event of the statement has its case for every zone, and that the pieces leave no gap."""
        found: dict[tuple[int, str, int], list[Event]] = {}
        for event in self.asked.events:
            found.setdefault((event.zone, event.kind, event.burn), []).append(event)
        for zone in range(len(self.asked.zones)):
            for kind, burn in self._needed():
                events = found.pop((zone, kind, burn), [])
                if not events:
                    raise ProofRejected(f"cases: required one for {kind}, burn {burn}, zone {zone}")
                self._pieces(kind, burn, events)

    def _needed(self) -> list[tuple[str, int]]:
        asked = self.asked
        needed = [("start", -1)]
        for k, duration in enumerate(asked.durations):
            needed += [("made", k)] + [("cut", k)] * (duration > 0)
            needed += [("partial", k)] * asked.partial + [("misdirected", k)] * (asked.misdirected > 0)
            needed += [("late", k)] * (asked.late > 0) + [("stuck", k)] * (asked.stuck > 0)
        return needed

    def _pieces(self, kind: str, burn: int, events: list[Event]) -> None:
        """Delays, and times for which a burn lasts, follow one another up to their largest."""
        asked, name = self.asked, f"{kind}, burn {burn}"
        whole = asked.durations[burn] if burn >= 0 else fmpq(0)
        if whole == 0:
            if any(any(event.on) for event in events):
                raise ProofRejected(f"cases: {name}: an impulse does not last")
            longest = {"late": asked.late, "stuck": asked.stuck}.get(kind)
            if longest is not None:
                _follow([(event.first, event.last) for event in events], fmpq(0), longest, name)
            return
        if kind == "stuck":
            if any(event.on != (whole, whole) for event in events):
                raise ProofRejected(
                    f"cases: {name}: required one that lasts for all its time before it goes on"
                )
            _follow([(event.first, event.last) for event in events], fmpq(0), asked.stuck, name)
            return
        by_delay: dict[tuple[fmpq, fmpq], list[tuple[fmpq, fmpq]]] = {}
        for event in events:
            by_delay.setdefault((event.first, event.last), []).append(event.on)
        if kind == "late":
            _follow(list(by_delay), fmpq(0), asked.late, name)
        elif set(by_delay) != {(fmpq(0), fmpq(0))}:
            raise ProofRejected(f"cases: {name}: required no delay")
        for lasting in by_delay.values():
            if kind != "cut":
                if (whole, whole) not in lasting:
                    raise ProofRejected(f"cases: {name}: required one in which it lasts for all its time")
                lasting.remove((whole, whole))
            if kind != "made" or lasting:
                _follow(lasting, fmpq(0), whole, name)

    def _covered(self, event: Event) -> None:
        """Check that the cells cover the drift."""
        reached, duration = self.window(event)
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
        """Until when a drift is followed, s after the planned time of its burn."""
        return self.window(event)[1]

    def window(self, event: Event) -> tuple[fmpq, fmpq]:
        """From when to when, s after its burn: the horizon, after a burn that ends late, and the wait for the next,
        late one."""
        asked, k = self.asked, event.burn
        if event.kind == "start":
            return fmpq(0), max(asked.horizon, asked.late)
        if asked.durations[k] > 0:
            return window(asked, event)
        if event.kind == "made" and k + 1 < len(asked.times):
            return fmpq(0), max(asked.horizon, asked.times[k + 1] - asked.times[k] + asked.late)
        return fmpq(0), asked.horizon + event.last


def _follow(spans: list[tuple[fmpq, fmpq]], begin: fmpq, end: fmpq, name: str) -> None:
    """Check that pieces of time lead from ``begin`` to ``end`` without a gap."""
    reached = begin
    for first, last in sorted(spans):
        if not first <= reached <= last or first < begin or last > end:
            raise ProofRejected(f"cases: {name}: the pieces must follow one another")
        reached = last
    if reached != end:
        raise ProofRejected(f"cases: {name}: the pieces end at {float(reached)} s, required {float(end)} s")
