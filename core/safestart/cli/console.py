"""Output of the commands: JSON alone on stdout, progress on stderr (a bar on a terminal, lines elsewhere)."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Annotated, Any, Literal

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from safestart.runtime.progress import Context

Justify = Literal["left", "right"]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout and nothing else.")]

# Least width of a table in a pipe, a log or a narrow terminal, which then folds lines instead of cutting figures
# off.
_LEAST_WIDTH = 112


def _console(*, stderr: bool) -> Console:
    console = Console(stderr=stderr, highlight=False)
    console.width = max(console.width, _LEAST_WIDTH)
    return console


def table_of(title: str, columns: Sequence[tuple[str, Justify]]) -> Table:
    """Empty table in our style."""
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    for name, justify in columns:
        table.add_column(name, justify=justify, no_wrap=True)
    return table


out = _console(stderr=False)
err = _console(stderr=True)


def print_json(document: Any) -> None:
    """One JSON document on stdout."""
    sys.stdout.write(json.dumps(document, allow_nan=False, indent=2) + "\n")


def number(value: float | None, digits: int = 3) -> str:
    """A figure for a table; a dash when there is none."""
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
    """Context that shows its progress on stderr while the work runs."""
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
            # Work done before this moment says nothing about the speed from here on.
            first = percent
        if percent < shown + 10.0:
            return
        shown = percent
        elapsed = time.monotonic() - start
        left = f", {elapsed * (100.0 - percent) / (percent - first):.0f} s left" if percent > first else ""
        err.print(f"{title}: {percent:3.0f} % {message} ({elapsed:.0f} s{left})", soft_wrap=True)

    yield Context(report)
    err.print(f"{title}: done in {time.monotonic() - start:.1f} s")
