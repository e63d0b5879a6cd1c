"""How the commands speak: JSON alone on stdout, progress on stderr (a bar on a terminal, lines elsewhere)."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer
from rich.console import Console

from safestart.progress import Context

Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout and nothing else.")]

# A pipe or a log has no width of its own: tables keep theirs there, a terminal folds them.
_WIDE = 124


def _console(*, stderr: bool) -> Console:
    console = Console(stderr=stderr, highlight=False)
    if not console.is_terminal:
        console.width = _WIDE
    return console


out = _console(stderr=False)
err = _console(stderr=True)


def print_json(document: Any) -> None:
    """One JSON document on stdout."""
    sys.stdout.write(json.dumps(document, allow_nan=False, indent=2) + "\n")


def number(value: float | None, digits: int = 3) -> str:
    """A figure for a table; a dash where there is none."""
    return "-" if value is None else f"{value:.{digits}f}"


def seconds(value: float | None) -> str:
    """A duration with the unit that suits it."""
    if value is None:
        return "-"
    if value < 1e-3:
        return f"{value * 1e6:.0f} us"
    return f"{value * 1e3:.1f} ms" if value < 1.0 else f"{value:.1f} s"


@contextmanager
def reporting(title: str) -> Iterator[Context]:
    """Context whose progress a person sees on stderr while the work runs."""
    with _bar(title) if err.is_terminal else _lines(title) as context:
        yield context


@contextmanager
def _bar(title: str) -> Iterator[Context]:
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
    with Progress(*columns, console=err, transient=False) as bar:
        task = bar.add_task(title, total=1.0)

        def report(done: float, total: float, message: str) -> None:
            text = f"{title} [{message}]" if message else title
            bar.update(task, completed=done / total if total else 1.0, description=text[:70].ljust(48))

        yield Context(report)
        bar.update(task, completed=1.0, description=title.ljust(48))


@contextmanager
def _lines(title: str) -> Iterator[Context]:
    start, shown, first = time.monotonic(), -10.0, 0.0

    def report(done: float, total: float, message: str) -> None:
        nonlocal shown, first
        percent = 100.0 * done / total if total else 100.0
        if shown < 0.0:
            # Work that was under way already says nothing about the speed from here on.
            first = percent
        if percent < shown + 10.0:
            return
        shown = percent
        elapsed = time.monotonic() - start
        left = f", {elapsed * (100.0 - percent) / (percent - first):.0f} s left" if percent > first else ""
        err.print(f"{title}: {percent:3.0f} % {message} ({elapsed:.0f} s{left})", soft_wrap=True)

    yield Context(report)
    err.print(f"{title}: done in {time.monotonic() - start:.1f} s")
