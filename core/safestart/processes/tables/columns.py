"""The columns of a process's tables, read from the models of its outputs: the same for every result.

A column that only some results fill is there in all of them, empty, and has its type.
"""

from __future__ import annotations

import types
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from annotated_types import MaxLen, MinLen
from pydantic import BaseModel

from safestart.processes.base import ProcessSpec

# A list of this many numbers at most is a vector, with one column per number.
MOST_ENTRIES = 8
Path = tuple[str | int, ...]
"""Where a row, which is an object, holds a value."""


class Kind(StrEnum):
    """The type of a column's cells."""

    FLAG = "flag"
    INTEGER = "integer"
    NUMBER = "number"
    TEXT = "text"
    NUMBERS = "numbers"
    """As many numbers as the question has, such as one for each face."""


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its name, the type of its cells, whether a cell may be empty, and where a row holds its value."""

    name: str
    kind: Kind
    nullable: bool
    path: Path


@dataclass(frozen=True, slots=True)
class TableColumns:
    """A table of a process: its columns, and which outputs its rows are made of.

    ``place`` names the list of objects, one or two members deep, ``inner`` the list within its rows; without
    ``place`` the table is declared by the process.
    """

    columns: tuple[Column, ...]
    place: tuple[str, ...] = ()
    inner: str = ""


def columns_of(spec: ProcessSpec) -> dict[str, TableColumns]:
    """The tables that results of a process have, by name: declared ones first."""
    fields = spec.outputs.model_fields
    found = {}
    for table in spec.tables:
        depth = 2 if table.axes else 1
        columns = [
            column
            for name in table.axes
            for column in _columns(name, _inside(fields[name].annotation, 1), (name,))
        ]
        for name in table.columns:
            columns += _columns(name, _inside(fields[name].annotation, depth), (name,), nullable=True)
        found[table.name] = TableColumns(tuple(columns))
    for name, annotation in _members(spec.outputs):
        found |= _of_objects((name,), annotation)
        kind, _ = _plain(annotation)
        if _is_model(kind) or _named(kind):
            for key, inner in _members(kind):
                found |= _of_objects((name, key), inner)
    return found


@dataclass(frozen=True, slots=True)
class OutputArray:
    """An output that is a number or an array of them: its type, whether numbers may be missing, and its ``shape``.

    ``shape`` has the least number of entries along each axis; it is () for a single number.
    """

    kind: Kind
    nullable: bool
    shape: tuple[int, ...]


def output_arrays(spec: ProcessSpec) -> dict[str, OutputArray]:
    """Outputs that are numbers or arrays of them, by name."""
    found = {}
    for name, annotation in _members(spec.outputs):
        shape = []
        kind, nullable = _plain(annotation)
        while get_origin(kind) is list:
            shape.append((_length(annotation) or (0, 0))[0])
            annotation = get_args(kind)[0]
            kind, inner = _plain(annotation)
            nullable = nullable or inner
        scalar = _scalar(kind)
        if scalar is not None and scalar is not Kind.TEXT:
            found[name] = OutputArray(scalar, nullable, tuple(shape))
    return found


def _of_objects(place: tuple[str, ...], annotation: Any) -> dict[str, TableColumns]:
    """The table of a list of objects, and those of the lists of objects within its rows."""
    item = _item(annotation)
    if item is None:
        return {}
    name, columns = ".".join(place), tuple(_row(item, ()))
    found = {name: TableColumns(columns, place)}
    for key, annotated in _members(item):
        inner = _item(annotated)
        if inner is not None:
            more = _columns(key, inner, (key,))
            found[f"{name}.{key}"] = TableColumns((*columns, *more), place, key)
    return found


def _row(model: Any, path: Path, before: str = "", *, nullable: bool = False) -> Iterator[Column]:
    for name, annotation in _members(model):
        yield from _columns(before + name, annotation, (*path, name), nullable=nullable)


def _columns(name: str, annotation: Any, path: Path, *, nullable: bool = False) -> Iterator[Column]:
    """The columns of a value; none of lists of objects, which are tables, and of arrays."""
    kind, absent = _plain(annotation)
    nullable = nullable or absent
    if _is_model(kind) or _named(kind):
        # An object may have some of its possible names only.
        yield from _row(kind, path, f"{name}.", nullable=nullable or _named(kind))
        return
    if get_origin(kind) is list:
        inner, _ = _plain(get_args(kind)[0])
        length = _length(annotation)
        if _is_model(inner) or get_origin(inner) is list:
            return
        if _scalar(inner) is Kind.TEXT:
            yield Column(name, Kind.TEXT, nullable, path)
        elif length is not None and length[1] <= MOST_ENTRIES:
            least, most = length
            for place in range(most):
                yield from _columns(
                    f"{name}.{place}", inner, (*path, place), nullable=nullable or place >= least
                )
        else:
            yield Column(name, Kind.NUMBERS, nullable, path)
        return
    yield Column(name, _scalar(kind) or Kind.TEXT, nullable, path)


def _members(model: Any) -> Iterator[tuple[str, Any]]:
    """Names and annotations of a model's fields, or of an object whose names are listed."""
    if _is_model(model):
        for name, field in model.model_fields.items():
            # pydantic keeps the constraints of an annotation beside it.
            yield name, Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    elif _named(model):
        names, value = get_args(model)
        for name in get_args(names):
            yield name, value


def _plain(annotation: Any) -> tuple[Any, bool]:
    """The type without its constraints, and whether None is allowed beside it."""
    if get_origin(annotation) is Annotated:
        return _plain(get_args(annotation)[0])
    if get_origin(annotation) in (Union, types.UnionType):
        kinds = [kind for kind in get_args(annotation) if kind is not types.NoneType]
        nullable = len(kinds) < len(get_args(annotation))
        if len(kinds) == 1:
            kind, inner = _plain(kinds[0])
            return kind, nullable or inner
        scalars = {_scalar(kind) for kind in kinds}
        return (float if scalars == {Kind.INTEGER, Kind.NUMBER} else str), nullable
    return annotation, False


def _length(annotation: Any) -> tuple[int, int] | None:
    """The least and the most entries of a list; None where they are not bounded."""
    for part in (annotation, *get_args(annotation)):
        if get_origin(part) is Annotated:
            least = [item.min_length for item in _constraints(part) if isinstance(item, MinLen)]
            most = [item.max_length for item in _constraints(part) if isinstance(item, MaxLen)]
            if least and most:
                return least[0], most[0]
    return None


def _constraints(annotated: Any) -> Iterator[Any]:
    for item in annotated.__metadata__:
        yield from getattr(item, "metadata", None) or (item,)


def _scalar(kind: Any) -> Kind | None:
    if get_origin(kind) is Literal:
        return Kind.TEXT
    if not isinstance(kind, type):
        return None
    if issubclass(kind, bool):
        return Kind.FLAG
    if issubclass(kind, str | Enum):
        return Kind.TEXT
    return Kind.INTEGER if issubclass(kind, int) else Kind.NUMBER if issubclass(kind, float) else None


def _inside(annotation: Any, depth: int) -> Any:
    for _ in range(depth):
        kind, _ = _plain(annotation)
        annotation = get_args(kind)[0]
    return annotation


def _item(annotation: Any) -> Any:
    """The model of a list's items; None for other lists and values."""
    kind, _ = _plain(annotation)
    if get_origin(kind) is not list:
        return None
    item, _ = _plain(get_args(kind)[0])
    return item if _is_model(item) else None


def _named(kind: Any) -> bool:
    """True for an object whose possible names are listed."""
    return get_origin(kind) in (dict, Mapping) and get_origin(get_args(kind)[0]) is Literal


def _is_model(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)
