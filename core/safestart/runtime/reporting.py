"""Progress of work for people: a bar on a terminal, lines elsewhere; and why it has not begun."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from safestart.runtime.progress import Context

if TYPE_CHECKING:
    from rich.console import Console

WAIT_EVERY_S = 5.0
"""Somebody who waits is told why as often as this."""


def _silent(reason: str) -> None:
    """Tell nobody."""


@dataclass(frozen=True, slots=True)
class Reporting(Context):
    """A context of work that may have to wait: ``waits(reason)`` before it runs, as often as the reason is looked at.

    The wait says nothing about the speed of the work, so that estimates begin with the first step after it.
    """

    waits: Callable[[str], None] = field(default=_silent)


@contextmanager
def reporting_on(console: Console, title: str) -> Iterator[Reporting]:
    """Context that shows its progress on ``console`` while the work runs."""
    with _bar(console, title) if console.is_terminal else _lines(console, title) as context:
        yield context


@contextmanager
def _bar(console: Console, title: str) -> Iterator[Reporting]:
    from rich.markup import escape
    from rich.progress import (
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    reasons = _Reasons()
    with Progress(*columns, console=console, transient=False) as bar:
        task = bar.add_task(title, total=1.0)

        def waits(reason: str) -> None:
            if not reasons.waiting:  # the bar pulses, its clock stands
                bar.reset(task, start=False, description=f"{title} waits".ljust(48))
            if reasons.due(reason, again=False):
                bar.console.print(escape(f"{title} waits: {reason}"), soft_wrap=True)

        def runs() -> None:
            if reasons.waiting:
                reasons.end()
                bar.start_task(task)

        def report(done: float, total: float, message: str) -> None:
            runs()
            text = f"{title} [{message}]" if message else title
            bar.update(task, completed=done / total if total else 1.0, description=text[:70].ljust(48))

        yield Reporting(report, waits=waits)
        runs()
        bar.update(task, completed=1.0, description=title.ljust(48))


@contextmanager
def _lines(console: Console, title: str) -> Iterator[Reporting]:
    begun = start = time.monotonic()
    shown, first = -10.0, (start, 0.0)
    reasons = _Reasons()

    def waits(reason: str) -> None:
        if reasons.due(reason, again=True):
            console.print(f"{title} waits: {reason} ({time.monotonic() - begun:.0f} s)", soft_wrap=True)

    def report(done: float, total: float, message: str) -> None:
        nonlocal start, shown, first
        now, percent = time.monotonic(), 100.0 * done / total if total else 100.0
        if reasons.waiting:
            reasons.end()
            start, shown = now, -10.0
        if shown < 0.0:
            # Work done before this moment says nothing about the speed from here on.
            first = (now, percent)
        if percent < shown + 10.0:
            return
        shown = percent
        since, before = first
        left = (
            f", {(now - since) * (100.0 - percent) / (percent - before):.0f} s left"
            if percent > before
            else ""
        )
        console.print(f"{title}: {percent:3.0f} % {message} ({now - start:.0f} s{left})", soft_wrap=True)

    yield Reporting(report, waits=waits)
    console.print(f"{title}: done in {time.monotonic() - begun:.1f} s")


class _Reasons:
    """When to tell the reason of a wait: at once, then every :data:`WAIT_EVERY_S`; a place in a long queue changes more
    often.
    """

    def __init__(self) -> None:
        self.waiting = False
        self._told, self._at = "", 0.0

    def due(self, reason: str, *, again: bool) -> bool:
        """Whether to tell it now; ``again``: also the one that was told last."""
        now, first = time.monotonic(), not self.waiting
        self.waiting = True
        if not first and (now - self._at < WAIT_EVERY_S or (reason == self._told and not again)):
            return False
        self._told, self._at = reason, now
        return True

    def end(self) -> None:
        """The work runs; another wait begins anew."""
        self.waiting = False
