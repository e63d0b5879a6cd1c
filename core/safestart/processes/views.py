"""How a page shows the outputs of a process: typed declarations beside ``tables``, served with its description.

A page knows how to draw each kind of view, and no process. ``table`` names one of the tables of the outputs, as CSV and
Parquet have them: a declared one, a list of objects, or ``outer.inner`` for lists of objects within its rows; "" is the
one row of the outputs' own scalars. A column's ``path`` is the name of that table's column.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any, ClassVar


@dataclass(frozen=True, slots=True)
class Column:
    """A column or a figure: its title for people, and where its value stands."""

    title: str
    path: str


@dataclass(frozen=True, slots=True)
class Findings:
    """Statements, each with a verdict in one word: they head the page, and the worst of them is the result's verdict.

    ``word`` is the column of the verdict. A word that is neither ``good`` nor ``bad`` decides nothing. ``basis`` is the
    output that says what the verdicts rest on; where it is one of ``unproved``, they are shown as claims without proof.
    """

    kind: ClassVar[str] = "findings"
    title: str
    table: str
    word: str
    columns: tuple[Column, ...] = ()
    good: tuple[str, ...] = ("GO", "SAFE", "HELD")
    bad: tuple[str, ...] = ("NO_GO", "UNSAFE", "BROKEN")
    basis: str = ""
    unproved: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Facts:
    """Figures out of the outputs' own scalars."""

    kind: ClassVar[str] = "facts"
    columns: tuple[Column, ...]


@dataclass(frozen=True, slots=True)
class Rows:
    """A table with titles for people. ``explore``: each row is a start that the page can lead to."""

    kind: ClassVar[str] = "rows"
    title: str
    table: str
    columns: tuple[Column, ...]
    note: str = ""
    explore: bool = False


@dataclass(frozen=True, slots=True)
class Matrices:
    """Confusion matrices: what was claimed of the cases (rows) against what was so (columns).

    ``path`` leads to each of them, ``*`` standing for every entry of a list or object; ``names`` are, for each ``*``,
    the member that names the entry, "" for its key. ``heading`` is made of these names, by their places. ``cells`` are
    the words for claimed and so, claimed and not so, not claimed and so, neither. ``omit``: names to leave out.
    """

    kind: ClassVar[str] = "matrices"
    title: str
    note: str
    path: str
    names: tuple[str, ...]
    heading: str
    claims: tuple[str, str]
    facts: tuple[str, str]
    cells: tuple[str, str, str, str]
    omit: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Overlay:
    """Two of the masks of an NPZ file against each other: ``NAME_mask`` on ``x_m``, ``y_m``, within ``inside``.

    The names are those in column ``by`` of the table whose ``cells`` are known. ``certain`` is the one that the others
    are looked at beside.
    """

    kind: ClassVar[str] = "overlay"
    title: str
    artifact: str
    table: str
    by: str
    certain: str


@dataclass(frozen=True, slots=True)
class Flights:
    """Flights of an NPZ file, ``NAME_body_m`` over ``NAME_time_s``, and the cases they belong to.

    ``path`` leads to lists of cases by group; each case is a start that Explore can show.
    """

    kind: ClassVar[str] = "flights"
    title: str
    artifact: str
    path: str
    columns: tuple[Column, ...]


@dataclass(frozen=True, slots=True)
class Comparison:
    """What two or more runs of the process are compared by: measures of the rows of a table, named by column ``by``."""

    kind: ClassVar[str] = "comparison"
    table: str
    by: str
    measures: tuple[Column, ...]
    logarithmic: tuple[str, ...] = ()


View = Findings | Facts | Rows | Matrices | Overlay | Flights | Comparison


def kinds(views: Iterable[View]) -> list[str]:
    """Kinds of views, each once, in their order."""
    return list(dict.fromkeys(view.kind for view in views))


def documents(views: Iterable[View]) -> list[dict[str, Any]]:
    """Views as JSON."""
    return [{"kind": view.kind, **asdict(view)} for view in views]
