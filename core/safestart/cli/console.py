"""Output of the commands: JSON alone on stdout, progress on stderr (a bar on a terminal, lines elsewhere)."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from typing import Annotated, Any, Literal

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.table import Table

from safestart.runtime.logs import legible
from safestart.runtime.reporting import Reporting, reporting_on

Justify = Literal["left", "right"]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout and nothing else.")]

# Least width of a table in a pipe, a log or a narrow terminal, which then folds lines instead of cutting figures
# off.
_LEAST_WIDTH = 112


class LegibleConsole(Console):
    """A console whose texts cannot act on the terminal, whoever wrote them; its own colours and bars do."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """The parts of what is printed, of every cell of a table too."""
        for part in super().render(renderable, options):
            yield part if part.control else part._replace(text=legible(part.text, keep="\n"))


def _console(*, stderr: bool) -> Console:
    console = LegibleConsole(stderr=stderr, highlight=False)
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


def reporting(title: str) -> AbstractContextManager[Reporting]:
    """Context that shows its progress on stderr while the work runs."""
    return reporting_on(err, title)
