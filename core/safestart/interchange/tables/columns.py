"""Tables of states and attitudes: CSV, Parquet, MATLAB 5; the same columns in each, units in their names.

States: ``epoch`` (text), ``x_m``, ``y_m``, ``z_m``, ``vx_m_s``, ``vy_m_s``, ``vz_m_s``. Attitudes: ``epoch``, ``q_s``,
``q_x``, ``q_y``, ``q_z`` (scalar first, reference to body). Columns of one value hold the contents of a message's
header: ``object``, ``object_id``, ``frame`` (``reference`` and ``body`` for attitudes), ``time_system``.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from safestart.errors import invalid
from safestart.interchange.attitude_course import AttitudeCourse
from safestart.interchange.ccsds.tokens import number
from safestart.interchange.ephemeris import MOST_STATES, Ephemeris
from safestart.interchange.epochs import epochs_of, shortened, text_of
from safestart.interchange.foreign import refuse_foreign
from safestart.interchange.source import refuse_many_lines
from safestart.interchange.source import text_of as decoded
from safestart.interchange.tables.matlab_read import arrays_in
from safestart.interchange.tables.parquet import columns_in
from safestart.model.scenario import Floats

STATE = ("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s")
TURN = ("q_s", "q_x", "q_y", "q_z")
_OF_STATES = ("object", "object_id", "frame", "time_system")
_OF_TURNS = ("object", "object_id", "reference", "body", "time_system")
KNOWN = ("epoch", *STATE, *TURN, *dict.fromkeys((*_OF_STATES, *_OF_TURNS)))
"""Columns of either kind of table."""
_LONGEST_LINE = 4096
Columns = dict[str, list[Any]]


def is_table(data: bytes, name: str) -> bool:
    """Whether these bytes are a table: by their first bytes, or the name's end for CSV."""
    return data[:4] == b"PAR1" or data[:6] == b"MATLAB" or name.lower().endswith((".csv", ".mat", ".parquet"))


def holds_turns(data: bytes, name: str) -> bool:
    """Whether the table's columns are those of attitudes."""
    return TURN[0] in _columns(data, name)


def ephemeris_of(data: bytes, name: str) -> Ephemeris:
    """States from a table; raises ``InvalidInput`` for missing or unknown columns and values that are not numbers."""
    columns = _columns(data, name)
    head = _head(columns, _OF_STATES, STATE)
    states = _numbers(columns, STATE)
    epochs = epochs_of(columns["epoch"], head["time_system"])
    return Ephemeris(head["object"], head["object_id"], head["frame"], head["time_system"], epochs, states)


def attitude_of(data: bytes, name: str) -> AttitudeCourse:
    """Attitudes from a table; raises ``InvalidInput`` as :func:`ephemeris_of` does."""
    columns = _columns(data, name)
    head = _head(columns, _OF_TURNS, TURN)
    turns = _numbers(columns, TURN)
    epochs = epochs_of(columns["epoch"], head["time_system"])
    named = (head["object"], head["object_id"], head["reference"], head["body"], head["time_system"])
    return AttitudeCourse(*named, epochs, turns)


def columns_of(course: Ephemeris | AttitudeCourse) -> Columns:
    """The columns of a course."""
    head: tuple[str, ...] = _OF_TURNS
    names: tuple[str, ...] = TURN
    if isinstance(course, Ephemeris):
        head, names, rows = _OF_STATES, STATE, course.states
        values: tuple[str, ...] = (course.name, course.object_id, course.frame)
    else:
        rows, values = course.quaternions, (course.name, course.object_id, course.reference, course.body)
    count = len(course.epochs)
    texts = [shortened(text) for text in text_of(course.epochs, course.time_system)]
    found: Columns = {"epoch": texts}
    found |= {name: column.tolist() for name, column in zip(names, rows.T, strict=True)}
    return found | {
        name: [value] * count for name, value in zip(head, (*values, course.time_system), strict=True)
    }


def csv_of(columns: Mapping[str, Sequence[Any]]) -> bytes:
    """CSV with a head, numbers to the last digit."""
    sink = io.StringIO()
    writer = csv.writer(sink, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    return sink.getvalue().encode()


def _columns(data: bytes, name: str) -> Columns:
    refuse_foreign(data)
    if data[:4] == b"PAR1":
        found: Columns = columns_in(data, KNOWN, MOST_STATES)
    elif data[:6] == b"MATLAB":
        found = arrays_in(data, MOST_STATES)
    elif name.lower().endswith(".csv"):
        found = _csv_in(data)
    else:
        raise invalid("file", "what its name says", f"{name}: {data[:16]!r}")
    lengths = {len(column) for column in found.values()}
    if len(lengths) != 1 or not 1 <= max(lengths) <= MOST_STATES:
        raise invalid("file", f"columns of one length, 1 to {MOST_STATES} rows", sorted(lengths))
    return found


def _csv_in(data: bytes) -> Columns:
    """Columns of texts; each row is in a line, and none beyond the first that does not fit is read."""
    text = decoded(data, "file")
    refuse_many_lines(text, MOST_STATES + 1)
    found: Columns = {}
    for place, line in enumerate(io.StringIO(text), 1):
        if len(line) > _LONGEST_LINE:
            raise invalid(f"line {place}", f"at most {_LONGEST_LINE} characters", len(line))
        try:
            row = next(csv.reader([line], strict=True), [])
        except csv.Error as error:
            raise invalid(f"line {place}", "values between commas", str(error)) from None
        if place == 1:
            if not row or len(set(row)) != len(row):
                raise invalid("file", "a head with every column once", row)
            found = {column: [] for column in row}
        elif len(row) != len(found):
            raise invalid(f"line {place}", f"{len(found)} values", f"{len(row)} (truncated)")
        else:
            for column, value in zip(found.values(), row, strict=True):
                column.append(value)
    if not found:
        raise invalid("file", "a head with every column once", "an empty file")
    return found


def _head(columns: Columns, head: Sequence[str], numbers: Sequence[str]) -> dict[str, str]:
    """Values common to all rows; raises ``InvalidInput`` for columns missing, unknown, or of several values."""
    required = ("epoch", *numbers, *head)
    for name in required:
        if name not in columns:
            raise invalid("file", f"columns {', '.join(required)}", f"no {name}")
    for name in columns:
        if name not in required:
            raise invalid("file", f"columns {', '.join(required)}", name)
    found = {}
    for name in head:
        values = set(columns[name])
        if len(values) != 1 or not isinstance(next(iter(values)), str):
            raise invalid(name, "one text in all rows", sorted(map(str, values))[:3])
        found[name] = str(next(iter(values)))
    if any(not isinstance(text, str) for text in columns["epoch"]):
        raise invalid("epoch", "texts", "others")
    return found


def _numbers(columns: Columns, names: Sequence[str]) -> Floats:
    out = np.empty((len(columns["epoch"]), len(names)))
    for k, name in enumerate(names):
        for row, value in enumerate(columns[name]):
            if isinstance(value, bool) or value is None:
                raise invalid(name, "a number", value)
            out[row, k] = number(value, row + 2, name) if isinstance(value, str) else float(value)
    if not np.isfinite(out).all():
        raise invalid("file", "finite numbers", "others")
    return out
