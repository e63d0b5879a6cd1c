"""Views against the outputs that they show: a wrong name is refused where the process is declared, not on its page."""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Protocol, Union, get_args, get_origin, get_type_hints

from pydantic import BaseModel

from safestart.processes.views.kinds import (
    Comparison,
    Facts,
    Findings,
    Flights,
    Layer,
    Matrices,
    Overlay,
    Picture,
    Rows,
    View,
)
from safestart.runtime.named import misregistered

_CELLS = ("tp", "fp", "fn", "tn", "precision", "recall")
_DRAWN, _COLOURS = (get_args(get_type_hints(Layer)[name]) for name in ("drawn", "colour"))
_WITH_VALUE = ("points", "positive", "heat")

Named = tuple[str, str]
"""A table and a column of it."""


class Declared(Protocol):
    """A table that a process declares."""

    @property
    def name(self) -> str:
        """Its name."""
        ...

    @property
    def columns(self) -> tuple[str, ...]:
        """Lists that stand side by side."""
        ...

    @property
    def axes(self) -> tuple[str, ...]:
        """Axes of maps."""
        ...


class _MissingError(LookupError):
    """Nothing has this name."""


@dataclass(frozen=True, slots=True)
class Shown:
    """What views may name: the models of a process's inputs and outputs, its declared tables, its engines."""

    inputs: type[BaseModel]
    outputs: type[BaseModel]
    tables: tuple[Declared, ...]
    engines: tuple[str, ...]

    def require(self, process_id: str, views: Iterable[View]) -> None:
        """Raise ``Misregistered`` for the first view that names what is not there."""
        for view in views:
            what = f"{view.kind} among the views of process {process_id}"
            for required, received, fits in _words(view, self.engines):
                if not fits:
                    raise misregistered(what, required, received)
            for table, path in _columns(view):
                self._require(what, view, table, path)

    def _require(self, what: str, view: View, table: str, path: str) -> None:
        try:
            self._rows(table)
        except _MissingError:
            raise misregistered(what, "a table of the outputs", table) from None
        try:
            if isinstance(view, Picture) and (owner := _owner(view, table, path)):
                _member(_step(_step(self.inputs, owner), "*"), path.removeprefix(f"{owner}."))
            else:
                self._column(table, path)
        except _MissingError:
            where = f"table {table!r}" if table else "the outputs"
            raise misregistered(what, f"a column of {where}", path) from None

    def _declared(self, table: str) -> Declared | None:
        return next((one for one in self.tables if one.name == table), None)

    def _rows(self, table: str) -> Any:
        return None if self._declared(table) else _follow(self.outputs, table)

    def _column(self, table: str, path: str) -> None:
        if declared := self._declared(table):
            name, _, rest = path.partition(".")
            if name not in (*declared.columns, *declared.axes):
                raise _MissingError
            _follow(_step(_step(self.outputs, name), "*"), rest if name in declared.columns else "")
            return
        parts, rows = (table.split(".") if table else []), _inner(self.outputs)
        if "*" in parts:  # cases by group
            _follow(_follow(rows, table), path)
            return
        if len(parts) == 2 and get_origin(_follow(rows, parts[0])) is not list:
            _follow(_step(_follow(rows, table), "*"), path)  # a list within an object
            return
        for depth, part in enumerate(parts):
            outer, rows = rows, _step(_step(rows, part), "*")
            if depth and not path.startswith(f"{part}."):
                rows = outer  # the outer row's values stand beside the inner one
            elif depth:
                path = path.removeprefix(f"{part}.")
        _follow(rows, path)


def _words(view: View, engines: tuple[str, ...]) -> Iterator[tuple[str, Any, bool]]:
    """What a view's own words must be, what they are, whether they are."""
    if isinstance(view, Findings):
        yield "words that are not good and bad at once", view.good, not set(view.good) & set(view.bad)
    if isinstance(view, Matrices):
        yield (
            "one name for each * of its path",
            view.names,
            view.path.split(".").count("*") == len(view.names),
        )
    if isinstance(view, Overlay):
        yield f"one of the engines {', '.join(engines)}", view.certain, view.certain in engines
    if isinstance(view, Picture):
        for layer in view.layers:
            yield f"drawn as one of {', '.join(_DRAWN)}", layer.drawn, layer.drawn in _DRAWN
            yield f"a colour of {', '.join(_COLOURS)}", layer.colour, layer.colour in _COLOURS
            valued = layer.drawn in _WITH_VALUE
            said = f"{'a' if valued else 'no'} value for a layer drawn as {layer.drawn}"
            yield said, layer.value, bool(layer.value) == valued


def _columns(view: View) -> Iterator[Named]:
    """The columns that a view names, with their tables."""
    match view:
        case Findings():
            yield from ((view.table, path) for path in (view.word, *(one.path for one in view.columns)))
            yield ("", view.basis) if view.basis else ("", "")
        case Facts():
            yield from (("", one.path) for one in view.columns)
        case Rows():
            yield from ((view.table, one.path) for one in view.columns)
        case Matrices():
            yield from ((f"{view.path}", name) for name in _CELLS)
        case Overlay():
            yield from ((view.table, path) for path in (view.by, "cells"))
        case Flights():
            yield from ((f"{view.path}.*.*", one.path) for one in view.columns)
        case Picture():
            for layer in view.layers:
                yield from ((layer.table, path) for path in (layer.x, layer.y, layer.value) if path)
        case Comparison():
            measured = (view.by, *(one.path for one in view.measures), *view.logarithmic)
            yield from ((view.table, path) for path in measured)


def _owner(view: Picture, table: str, path: str) -> str:
    """The list among the inputs whose entries have this column, or empty."""
    owners = (layer.beside for layer in view.layers if layer.table == table and layer.beside)
    return next((one for one in owners if path.startswith(f"{one}.")), "")


def _inner(kind: Any) -> Any:
    """The type without None and annotations."""
    if get_origin(kind) is Annotated:
        return _inner(get_args(kind)[0])
    if get_origin(kind) in (Union, types.UnionType):
        some = [one for one in get_args(kind) if one is not type(None)]
        return _inner(some[0]) if len(some) == 1 else kind
    return kind


def _step(kind: Any, part: str) -> Any:
    """The type behind one part of a path: a member, an entry of a list or object."""
    kind = _inner(kind)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        members = {field.alias or name: field for name, field in kind.model_fields.items()}
        if part not in members:
            raise _MissingError
        return members[part].annotation
    if get_origin(kind) not in (dict, list, tuple):
        raise _MissingError
    return [one for one in get_args(kind) if one is not ...][-1]


def _follow(kind: Any, path: str) -> Any:
    for part in path.split(".") if path else []:
        kind = _step(kind, part)
    return _inner(kind)


def _member(kind: Any, path: str) -> None:
    """A member of an input's entry, which is a model or a dataclass."""
    kind, (name, _, rest) = _inner(kind), path.partition(".")
    if not dataclasses.is_dataclass(kind):
        _follow(_step(kind, name), "*" if rest else "")
    elif name not in {field.name for field in dataclasses.fields(kind)}:
        raise _MissingError
