"""Progress of work for people: a bar on a terminal, lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from safestart.runtime.progress import Context

if TYPE_CHECKING:
    from rich.console import Console


@contextmanager
def reporting_on(console: Console, title: str) -> Iterator[Context]:
    """Context that shows its progress on ``console`` while the work runs."""
    with _bar(console, title) if console.is_terminal else _lines(console, title) as context:
        yield context


@contextmanager
def _bar(console: Console, title: str) -> Iterator[Context]:
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
    with Progress(*columns, console=console, transient=False) as bar:
        task = bar.add_task(title, total=1.0)

        def report(done: float, total: float, message: str) -> None:
            text = f"{title} [{message}]" if message else title
            bar.update(task, completed=done / total if total else 1.0, description=text[:70].ljust(48))

        yield Context(report)
        bar.update(task, completed=1.0, description=title.ljust(48))


@contextmanager
def _lines(console: Console, title: str) -> Iterator[Context]:
    start, shown, first = time.monotonic(), -10.0, 0.0

    def report(done: float, total: float, message: str) -> None:
        nonlocal shown, first
        percent = 100.0 * done / total if total else 100.0
        if shown < 0.0:
            # Work done before this moment says nothing about the speed from here on.
            first = percent
        if percent < shown + 10.0:
            return
        shown = percent
        elapsed = time.monotonic() - start
        left = f", {elapsed * (100.0 - percent) / (percent - first):.0f} s left" if percent > first else ""
        console.print(f"{title}: {percent:3.0f} % {message} ({elapsed:.0f} s{left})", soft_wrap=True)

    yield Context(report)
    console.print(f"{title}: done in {time.monotonic() - start:.1f} s")
