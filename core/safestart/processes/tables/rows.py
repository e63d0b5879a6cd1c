"""Tables by the values of outputs: lists of objects, and the tables that a process declares over its other lists.

Lengths do not show which lists belong side by side: the axes of a map often have equal lengths.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from safestart.processes.base import Table

Rows = list[dict[str, Any]]
# A list of at most this many numbers is a vector, with one column per number.
_MOST_ENTRIES = 8


def tables_of(outputs: dict[str, Any], declared: Iterable[Table] = ()) -> dict[str, Rows]:
    """The tables among outputs by name: declared ones, then lists of objects.

    A list of objects within the rows of another list is a table too, ``outer.inner``, beside its row's scalars. So is
    a list within an object, without anything beside it.
    """
    found = {}
    for table in declared:
        rows = _declared(outputs, table)
        if rows:
            found[table.name] = rows
    for name, value in outputs.items():
        if _objects(value):
            found |= _objects_tables(name, value)
        elif isinstance(value, dict):
            for key, items in value.items():
                if _objects(items):
                    found |= _objects_tables(f"{name}.{key}", items)
    return {name: _tidy(rows) for name, rows in found.items()}


def names_of(rows: Rows) -> list[str]:
    """Names of all columns, in the order of their first appearance."""
    return list(dict.fromkeys(name for row in rows for name in row))


def _declared(outputs: dict[str, Any], table: Table) -> Rows:
    """Rows of a declared table; none if columns are missing or differ in length."""
    columns = {name: outputs[name] for name in table.columns if outputs.get(name) is not None}
    if not columns or any(name not in outputs for name in table.axes):
        return []
    try:
        if not table.axes:
            rows = zip(*columns.values(), strict=True)
            return [_flat(dict(zip(columns, row, strict=True))) for row in rows]
        first, second = table.axes
        return [
            {first: one, second: two, **dict(zip(columns, cell, strict=True))}
            for one, *lines in zip(outputs[first], *columns.values(), strict=True)
            for two, *cell in zip(outputs[second], *lines, strict=True)
        ]
    except ValueError:
        return []


def _objects(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(row, dict) for row in value)


def _objects_tables(name: str, value: Rows) -> dict[str, Rows]:
    found: dict[str, Rows] = {name: [_flat(row) for row in value]}
    inner: dict[str, Rows] = {}
    for row, flat in zip(value, found[name], strict=True):
        for key, items in row.items():
            if _objects(items):
                rows = [flat | _flat({key: item}) for item in items]
                inner.setdefault(f"{name}.{key}", []).extend(rows)
    return found | inner


def _flat(row: dict[str, Any]) -> dict[str, Any]:
    """The scalars of a row: inner objects as ``name.member``, vectors as ``name.0``, short words as one text."""
    found: dict[str, Any] = {}
    for name, value in row.items():
        if isinstance(value, dict):
            found.update({f"{name}.{key}": item for key, item in _flat(value).items()})
        elif not isinstance(value, list):
            found[name] = value
        elif all(isinstance(item, str) for item in value):
            found[name] = " ".join(value)
        elif len(value) <= _MOST_ENTRIES and not any(isinstance(item, list | dict) for item in value):
            found.update({f"{name}.{place}": item for place, item in enumerate(value)})
    return found


def _tidy(rows: Rows) -> Rows:
    """Drop columns that only mark a missing object whose members have columns."""
    names = names_of(rows)
    outer = {name.rpartition(".")[0] for name in names}
    outer |= {name[:place] for name in outer for place, letter in enumerate(name) if letter == "."}
    empty = {name for name in outer & set(names) if all(row.get(name) is None for row in rows)}
    return [{name: row.get(name) for name in names if name not in empty} for row in rows]
