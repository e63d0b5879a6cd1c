"""Tallies: pieces add up to the whole, in any order; unknown values are left out; wrong tables are refused."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safestart.campaign.combined import Each, Grouped
from safestart.campaign.kept import Kept, Listed
from safestart.campaign.rates import Confusion, Share
from safestart.campaign.spread import Spread
from safestart.campaign.table import CASE, Column, Kind, Table
from safestart.campaign.tally import Flagged, Known, Rows, Tally, Total, Values
from safestart.errors import InvalidInput

COLUMNS = (
    CASE,
    Column("good", Kind.FLAG),
    Column("said", Kind.FLAG),
    Column("size", Kind.NUMBER),
    Column("steps", Kind.SMALL),
    Column("cell", Kind.INTEGER),
    Column("why", Kind.TEXT),
)
TALLIES: dict[str, Tally] = {
    "rows": Rows(),
    "known": Known("said"),
    "flagged": Flagged("said"),
    "total": Total("steps"),
    "share": Share("said"),
    "confusion": Confusion("said", "good"),
    "values": Values("why"),
    "kept": Kept(3, ("good", "size"), "said"),
    "first": Kept(2),
    "none": Kept(0),
    "listed": Listed(("size", "why")),
    "grouped": Grouped("cell", Each({"share": Share("good"), "steps": Total("steps")})),
}
NUMBERS = st.one_of(st.none(), st.floats(-1e6, 1e6), st.sampled_from([math.nan, math.inf, -math.inf]))
ROW = st.fixed_dictionaries(
    {
        "good": st.booleans(),
        "said": st.one_of(st.none(), st.booleans()),
        "size": NUMBERS,
        "steps": st.one_of(st.none(), st.integers(0, 50)),
        "cell": st.one_of(st.none(), st.integers(-2, 2)),
        "why": st.one_of(st.none(), st.sampled_from(["late", "lost", ""])),
    }
)
PIECES = st.lists(st.lists(ROW, max_size=6), max_size=5)


def numbered(pieces: list[list[dict[str, Any]]]) -> list[list[dict[str, Any]]]:
    count = iter(range(1000))
    return [[{"case": next(count), **row} for row in piece] for piece in pieces]


def added(tally: Tally, tables: list[Table]) -> Any:
    state = tally.of(Table.joined(COLUMNS, ()))
    for table in tables:
        state = tally.add(state, json.loads(json.dumps(tally.of(table), allow_nan=False)))
    return state


@given(pieces=PIECES, order=st.randoms(use_true_random=False))
def test_pieces_add_up_in_any_order(pieces: list[list[dict[str, Any]]], order: Any) -> None:
    rows = numbered(pieces)
    tables = [Table.of_rows(COLUMNS, piece) for piece in rows]
    table = Table.of_rows(COLUMNS, [row for piece in rows for row in piece])
    whole = {name: tally.said(tally.of(table)) for name, tally in TALLIES.items()}
    joined = Table.joined(COLUMNS, tables)
    assert {name: tally.said(tally.of(joined)) for name, tally in TALLIES.items()} == whole
    order.shuffle(tables)
    assert {name: tally.said(added(tally, tables)) for name, tally in TALLIES.items()} == whole


@given(st.lists(st.lists(st.floats(-1e3, 1e3), max_size=6), max_size=5))
def test_spreads_of_pieces_are_those_of_the_whole(pieces: list[list[float]]) -> None:
    columns = (CASE, Column("size", Kind.NUMBER))
    tables = [
        Table.of(columns, {"case": np.arange(len(p)), "size": np.array(p, dtype=float)}) for p in pieces
    ]
    tally = Spread("size")
    state = tally.of(Table.joined(columns, ()))
    for table in tables:
        state = tally.add(state, tally.of(table))
    values = [value for piece in pieces for value in piece]
    found = tally.said(state)
    assert found["count"] == len(values)
    if values:
        assert found["mean"] == pytest.approx(np.mean(values), rel=1e-9, abs=1e-9)
        assert found["std"] == pytest.approx(np.std(values), rel=1e-6, abs=1e-6)
        assert (found["least"], found["most"]) == (min(values), max(values))
    else:
        assert found["mean"] is found["std"] is found["least"] is None


def test_what_is_unknown_is_not_counted() -> None:
    rows = [
        {"case": 0, "good": True, "said": None, "size": 2.0, "steps": 3, "cell": None, "why": None},
        {"case": 1, "good": False, "said": True, "size": None, "steps": None, "cell": 4, "why": "late"},
        {"case": 2, "good": True, "said": True, "size": 1.0, "steps": 5, "cell": 4, "why": "late"},
    ]
    table = Table.of_rows(COLUMNS, rows)
    said = {name: tally.said(tally.of(table)) for name, tally in TALLIES.items()}
    assert (said["rows"], said["known"], said["flagged"], said["total"]) == (3, 2, 2, 8)
    assert (said["share"]["count"], said["share"]["cases"]) == (2, 2)
    assert [said["confusion"][name] for name in ("tp", "fp", "fn", "tn")] == [1, 1, 0, 0]
    assert said["confusion"]["recall"] == 1.0
    assert said["confusion"]["wilson_95"]["false_positive_rate"] == pytest.approx([0.2065, 1.0], abs=1e-4)
    assert said["values"] == {"late": 2}
    assert [row["case"] for row in said["kept"]] == [1, 2]
    assert said["first"] == rows[:2]
    assert said["none"] == []
    assert said["listed"] == {"case": [0, 1, 2], "size": [2.0, None, 1.0], "why": [None, "late", "late"]}
    assert list(said["grouped"]) == [4]
    assert said["grouped"][4]["steps"] == 5
    assert Spread("size", "good").said(Spread("size", "good").of(table))["mean"] == 1.5


def test_what_is_not_finite_is_kept_first() -> None:
    columns = (CASE, Column("size", Kind.NUMBER))
    sizes = np.array([3.0, math.nan, -5.0, math.inf, 1.0])
    kept = Kept(4, ("size",)).of(Table.of(columns, {"case": np.arange(5), "size": sizes}))
    assert [(row["case"], row["size"]) for row in kept] == [(1, None), (3, None), (2, -5.0), (4, 1.0)]


@pytest.mark.parametrize(
    ("values", "named"),
    [
        ({"case": [0, 1]}, "required case, size, received 'case'"),
        ({"case": [0, 1], "size": [1.0, 2.0], "more": [0, 0]}, "received 'case, size, more'"),
        ({"case": [0, 1], "size": [1.0]}, "one length"),
        ({"case": [0, 1], "size": [[1.0], [2.0]]}, "one length"),
        ({"case": [0, 1], "size": ["a", "b"]}, "column size"),
        ({"case": [0.5, 1.5], "size": [1.0, 2.0]}, "column case"),
    ],
)
def test_tables_that_are_not_what_their_columns_say(values: dict[str, Any], named: str) -> None:
    columns = (CASE, Column("size", Kind.NUMBER))
    with pytest.raises(InvalidInput, match=named):
        Table.of(columns, {name: np.array(value) for name, value in values.items()})


def test_no_column_twice() -> None:
    with pytest.raises(InvalidInput):
        Table.of((CASE, CASE), {"case": np.arange(2)})
