"""Outcomes of cases as typed columns, some of their values unknown."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from safestart.errors import invalid
from safestart.model.scenario import Bools

Array = np.ndarray[tuple[int], np.dtype[Any]]


class Kind(StrEnum):
    """The type of a column; the values are its names in NumPy and Arrow."""

    INTEGER = "int64"
    SMALL = "int32"
    NUMBER = "float64"
    FLAG = "bool"
    TEXT = "object"


@dataclass(frozen=True, slots=True)
class Column:
    """A column of outcomes; an unrecorded column serves only the tallies."""

    name: str
    kind: Kind
    recorded: bool = True


_FILLER = {Kind.INTEGER: 0, Kind.SMALL: 0, Kind.NUMBER: 0.0, Kind.FLAG: False, Kind.TEXT: ""}

CASE = Column("case", Kind.INTEGER)
"""The number of the case; every table has this column."""


@dataclass(frozen=True, slots=True)
class Table:
    """M rows: ``values`` (M,) by column, and ``missing`` (M,) where a column has unknown values."""

    columns: tuple[Column, ...]
    values: Mapping[str, Array]
    missing: Mapping[str, Bools]

    @classmethod
    def of(cls, columns: Sequence[Column], values: Mapping[str, Any]) -> Table:
        """From arrays (M,), or masked arrays where values are unknown.

        Raises ``InvalidInput`` unless each column has one array of its type and all have one length.
        """
        _check(columns, values)
        arrays: dict[str, Array] = {}
        missing: dict[str, Bools] = {}
        for column in columns:
            found = values[column.name]
            if np.ma.isMaskedArray(found):
                missing[column.name] = np.ma.getmaskarray(found)
                found = np.ma.getdata(found)
            arrays[column.name] = _cast(column, np.asarray(found))
        shapes = {array.shape for array in arrays.values()}
        if len(shapes) != 1 or any(len(shape) != 1 for shape in shapes):
            raise invalid("columns", "arrays (M,) of one length", sorted(shapes))
        return cls(tuple(columns), arrays, missing)

    @classmethod
    def of_rows(cls, columns: Sequence[Column], rows: Sequence[Mapping[str, Any]]) -> Table:
        """From one mapping per row, None where a value is unknown; raises ``InvalidInput`` as :meth:`of`."""
        for row in rows:
            _check(columns, row)
        values: dict[str, Any] = {}
        for column in columns:
            given = [row[column.name] for row in rows]
            data = np.array([_FILLER[column.kind] if value is None else value for value in given])
            unknown = [value is None for value in given]
            values[column.name] = np.ma.masked_array(data, unknown) if any(unknown) else data
        return cls.of(columns, values)

    @classmethod
    def joined(cls, columns: Sequence[Column], tables: Sequence[Table]) -> Table:
        """All rows of tables with the same columns."""
        empty = [np.empty(0, dtype=bool)]
        return cls(
            tuple(columns),
            {
                c.name: np.concatenate([t.values[c.name] for t in tables] or empty, dtype=c.kind.value)
                for c in columns
            },
            {
                c.name: np.concatenate([~t.known(c.name) for t in tables])
                for c in columns
                if any(c.name in t.missing for t in tables)
            },
        )

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.values[self.columns[0].name])

    def known(self, name: str) -> Bools:
        """Where a column has a value, (M,)."""
        missing = self.missing.get(name)
        return np.ones(len(self), np.bool_) if missing is None else ~missing

    def flagged(self, name: str) -> Bools:
        """Where a flag is known and set, (M,)."""
        return np.asarray(self.values[name] & self.known(name), dtype=np.bool_)

    def taken(self, rows: slice | Array) -> Table:
        """Some of the rows."""
        return Table(
            self.columns,
            {name: values[rows] for name, values in self.values.items()},
            {name: missing[rows] for name, missing in self.missing.items()},
        )

    def listed(self, name: str) -> list[Any]:
        """A column for JSON: None for unknown values and non-finite numbers."""
        values, known = self.values[name].tolist(), self.known(name).tolist()
        return [
            value if here and not (isinstance(value, float) and not math.isfinite(value)) else None
            for value, here in zip(values, known, strict=True)
        ]

    def rows(self) -> list[dict[str, Any]]:
        """Row by row for JSON."""
        lists = [self.listed(column.name) for column in self.columns]
        names = [column.name for column in self.columns]
        return [dict(zip(names, row, strict=True)) for row in zip(*lists, strict=True)]


def _cast(column: Column, values: Array) -> Array:
    kind = np.dtype(column.kind.value)
    text = column.kind is Kind.TEXT
    fits = values.dtype.kind in "UO" if text else np.can_cast(values.dtype, kind, "same_kind")
    if len(values) and not fits:
        raise invalid(
            f"column {column.name}", f"values of kind {column.kind.name.lower()}", values.dtype.name
        )
    return values.astype(kind)


def _check(columns: Sequence[Column], values: Mapping[str, Any]) -> None:
    names = [column.name for column in columns]
    if set(names) != set(values) or len(set(names)) != len(names):
        raise invalid("columns", ", ".join(names), ", ".join(values))
