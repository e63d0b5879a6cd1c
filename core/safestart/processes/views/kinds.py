"""How a page shows the outputs of a process: typed declarations, like ``tables``, served with its description.

A page can draw each kind of view and knows no process. ``table`` names a table of the outputs, as in CSV and Parquet: a
declared table, a list of objects, or ``outer.inner`` for lists of objects within its rows; "" is the single row of the
outputs' own scalars. A column's ``path`` is its name in that table.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any, ClassVar, Literal


@dataclass(frozen=True, slots=True)
class Column:
    """A column or a figure: its title, and the path of its value."""

    title: str
    path: str


@dataclass(frozen=True, slots=True)
class Findings:
    """Statements, each with a one-word verdict: they head the page, and the worst verdict is the result's.

    ``word`` is the column of the verdict. A word that is neither ``good`` nor ``bad`` decides nothing. ``basis`` is the
    output that names the basis of the verdicts; if it is one of ``unproved``, the page shows them as claims without
    proof.
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
    """A table with column titles. ``explore``: each row is a start that links to Explore."""

    kind: ClassVar[str] = "rows"
    title: str
    table: str
    columns: tuple[Column, ...]
    note: str = ""
    explore: bool = False


@dataclass(frozen=True, slots=True)
class Matrices:
    """Confusion matrices: the claim about the cases (rows) against the truth (columns).

    ``path`` leads to each matrix, with ``*`` for every entry of a list or object; ``names`` gives, for each ``*``, the
    member that names the entry, "" for its key. ``heading`` is a template for these names. ``cells`` are the words for
    claimed and true, claimed and false, not claimed and true, neither. ``omit``: names to leave out.
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
    """Compare two masks of an NPZ file: ``NAME_mask`` on ``x_m``, ``y_m``, within ``inside``.

    The names are those in column ``by`` of the table whose ``cells`` are known. The page compares the others with
    ``certain``.
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
class Scene:
    """A flight about a turning body, animated in space, from an NPZ file.

    Arrays over ``time_s`` (K,): ``position_lvlh_m`` (K, 3), ``attitude`` (K, 3, 3) from LVLH to the body, and
    ``reference_m`` (K - 1, 3) in the body; ``outline_m`` (E, 2, 3): edges fixed in the body.
    """

    kind: ClassVar[str] = "scene"
    title: str
    artifact: str


@dataclass(frozen=True, slots=True)
class Comparison:
    """Measures for the comparison of two or more runs: columns of a table whose rows column ``by`` names."""

    kind: ClassVar[str] = "comparison"
    table: str
    by: str
    measures: tuple[Column, ...]
    logarithmic: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Layer:
    """Rows of a table as one layer of a picture: columns ``x`` and ``y``, and for some ``value``.

    ``drawn``: a line, the area within a closed line, points (``value``: their verdicts), the set where ``value`` is
    positive, or a heat map of ``value``. ``beside`` names the list among the inputs whose entries belong to the rows; a
    column ``beside.NAME`` is theirs. ``colour`` is a name of the pages' palette. ``{faces.0}`` in a title, also of an
    axis, is the first of the outputs' ``faces``.
    """

    title: str
    drawn: Literal["line", "area", "points", "positive", "heat"]
    table: str
    x: str
    y: str
    value: str = ""
    beside: str = ""
    colour: Literal["certified", "exact", "limit", "lost", "ink", "soft"] = "ink"


@dataclass(frozen=True, slots=True)
class Picture:
    """Layers over two axes. ``equal``: one scale for both, and the inputs' corridor is drawn; ``logarithmic``: y."""

    kind: ClassVar[str] = "picture"
    title: str
    x: str
    y: str
    layers: tuple[Layer, ...]
    equal: bool = False
    logarithmic: bool = False


View = Findings | Facts | Rows | Matrices | Overlay | Flights | Scene | Comparison | Picture


def kinds(views: Iterable[View]) -> list[str]:
    """Kinds of views, each once, in their order."""
    return list(dict.fromkeys(view.kind for view in views))


def documents(views: Iterable[View]) -> list[dict[str, Any]]:
    """Views as JSON."""
    return [{"kind": view.kind, **asdict(view)} for view in views]
