"""The tables of a result, with the columns and types of its process's models."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from safestart.processes.base import ProcessSpec, Table
from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.tables.columns import Kind, Path, TableColumns, columns_of
from safestart.processes.tables.rows import names_of, tables_of


@dataclass(frozen=True, slots=True)
class TypedTable:
    """A table: type and cells of each column by name. ``nullable``: columns in which a cell may be None."""

    kinds: dict[str, Kind]
    nullable: frozenset[str]
    cells: dict[str, list[Any]]

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(next(iter(self.cells.values()), []))

    def as_rows(self) -> list[dict[str, Any]]:
        """One object per row."""
        return [dict(zip(self.cells, row, strict=True)) for row in zip(*self.cells.values(), strict=True)]


def known_process(document: Mapping[str, Any]) -> ProcessSpec | None:
    """The process of a result document if it is the one of this version."""
    made = document.get("process", {})
    if made.get("id") not in PROCESS_IDS:
        return None
    spec = process(made["id"])
    return spec if made.get("version") == spec.version else None


def typed_tables(document: Mapping[str, Any]) -> dict[str, TypedTable]:
    """The tables of a result by name, the first the most important; the same names for all results of a process.

    Of another version's process, or an unknown one, the values say what the columns are.
    """
    outputs, spec = document["outputs"], known_process(document)
    if spec is None:
        made = document.get("process", {}).get("id")
        declared = process(made).tables if made in PROCESS_IDS else ()
        return {name: _guessed(rows) for name, rows in tables_of(outputs, declared).items()}
    declared_tables = {table.name: table for table in spec.tables}
    found = {}
    for name, table in columns_of(spec).items():
        objects = list(_objects(outputs, table, declared_tables.get(name)))
        cells = {
            column.name: [_cell(column.kind, _at(row, column.path)) for row in objects]
            for column in table.columns
        }
        nullable = frozenset(column.name for column in table.columns if column.nullable)
        found[name] = TypedTable({column.name: column.kind for column in table.columns}, nullable, cells)
    return found


def _objects(
    outputs: Mapping[str, Any], table: TableColumns, declared: Table | None
) -> Iterator[dict[str, Any]]:
    if not table.place:
        assert declared is not None
        yield from _declared(outputs, declared)
        return
    rows: Any = outputs
    for part in table.place:
        rows = (rows or {}).get(part)
    for row in rows or ():
        if not table.inner:
            yield row
        else:
            yield from ({**row, table.inner: item} for item in row[table.inner] or ())


def _declared(outputs: Mapping[str, Any], table: Table) -> Iterator[dict[str, Any]]:
    """A row for each entry of the lists, or for each cell over the axes; lists of other lengths give none."""
    lists = {name: outputs[name] for name in table.columns if outputs.get(name) is not None}
    if not lists or any(outputs.get(name) is None for name in table.axes):
        return
    if not table.axes:
        if len({len(one) for one in lists.values()}) == 1:
            yield from (dict(zip(lists, row, strict=True)) for row in zip(*lists.values(), strict=True))
        return
    first, second = (outputs[name] for name in table.axes)
    if any(len(one) != len(first) or any(len(line) != len(second) for line in one) for one in lists.values()):
        return
    for i, one in enumerate(first):
        for k, two in enumerate(second):
            yield {
                table.axes[0]: one,
                table.axes[1]: two,
                **{name: whole[i][k] for name, whole in lists.items()},
            }


def _at(row: Any, path: Path) -> Any:
    for part in path:
        if isinstance(part, int):
            row = row[part] if isinstance(row, list) and part < len(row) else None
        else:
            row = row.get(part) if isinstance(row, dict) else None
    return row


def _cell(kind: Kind, value: Any) -> Any:
    """A value as its column's type has it; objects and lists in a column of texts are written as words or JSON."""
    if value is None:
        return None
    if kind is Kind.NUMBERS:
        return [float(item) if item is not None else None for item in value]
    if kind is Kind.NUMBER:
        return float(value)
    if kind is not Kind.TEXT or isinstance(value, str):
        return value
    if isinstance(value, list) and all(isinstance(item, str) for item in value):
        return " ".join(value)
    return json.dumps(value, separators=(",", ":"), sort_keys=True)


def _guessed(rows: Iterable[dict[str, Any]]) -> TypedTable:
    """Columns by their values: integers mixed with floats are numbers, any other mixture is text."""
    rows = list(rows)
    kinds, cells = {}, {}
    for name in names_of(rows):
        values = [row.get(name) for row in rows]
        found = {type(value) for value in values if value is not None}
        kind = {
            frozenset({bool}): Kind.FLAG,
            frozenset({int}): Kind.INTEGER,
            frozenset({float}): Kind.NUMBER,
            frozenset({int, float}): Kind.NUMBER,
            frozenset(): Kind.NUMBER,
        }.get(frozenset(found), Kind.TEXT)
        kinds[name] = kind
        cells[name] = [value if value is None or kind is not Kind.TEXT else str(value) for value in values]
        if kind is Kind.NUMBER:
            cells[name] = [None if value is None else float(value) for value in cells[name]]
    return TypedTable(kinds, frozenset(kinds), cells)
