"""Results as tables: which lists belong together is said by each process, never guessed from their lengths."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np
import pytest

from safestart.processes.execute import execute
from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.tables import tables_of
from safestart.records import parquet
from safestart_service.documents.formats.registry import BY_NAME

STATES = [{"x_m": 5, "y_m": 40}, {"x_m": 0, "y_m": 140}, {"x_m": 90, "y_m": 20}]
TWO = {"states": STATES[:2]}


def record_of(name: str, **inputs: Any) -> dict[str, Any]:
    return execute(name, {**process(name).example, **inputs}).document


def read(record: dict[str, Any], table: str | None = None) -> list[dict[str, Any]]:
    """The table as CSV has it; Parquet has the same columns and as many rows."""
    rows = list(csv.DictReader(io.StringIO(BY_NAME["csv"].encode(record, table).decode())))
    columnar = parquet.read(BY_NAME["parquet"].encode(record, table))
    assert (columnar.column_names, columnar.num_rows) == (list(rows[0]), len(rows))
    return rows


def test_every_declared_list_is_an_output() -> None:
    for name in PROCESS_IDS:
        spec = process(name)
        for table in spec.tables:
            assert {*table.columns, *table.axes} <= set(spec.outputs.model_fields), name
            assert len(table.axes) in (0, 2)


@pytest.mark.parametrize("states", [STATES, TWO["states"]])
def test_verdicts_have_a_row_for_each_state(states: list[dict[str, float]]) -> None:
    record = record_of("go-no-go", states=states)
    rows = read(record)
    assert [row["verdict"] for row in rows] == record["outputs"]["verdict"]
    margins = [[float(margin) for margin in row["face_margins_m"].split()] for row in rows]
    assert margins == record["outputs"]["face_margins_m"]


@pytest.mark.parametrize(("nx", "ny"), [(7, 7), (7, 4)])
def test_a_map_has_a_row_for_each_cell_however_long_its_sides_are(nx: int, ny: int) -> None:
    record = record_of("certificate", grid={"nx": nx, "ny": ny, "y_max_m": 150})
    outputs, rows = record["outputs"], read(record)
    assert len(rows) == nx * ny
    row = rows[2 * nx + 3]
    assert (float(row["x_m"]), float(row["y_m"])) == (outputs["x_m"][3], outputs["y_m"][2])
    assert float(row["margin_m"]) == outputs["margin_m"][2][3]
    assert row["mask"] == str(outputs["mask"][2][3])


def test_curves_and_polygons_have_a_row_for_each_point() -> None:
    flight = record_of("flight")
    rows = read(flight)
    assert len(rows) == len(flight["outputs"]["time_s"])
    assert [float(rows[4]["body_m.0"]), float(rows[4]["body_m.1"])] == flight["outputs"]["body_m"][4]
    region = record_of("safe-region")
    for name in ("inner_polygon_m", "outer_polygon_m"):
        assert [[float(x) for x in row.values()] for row in read(region, name)] == region["outputs"][name]
    gained = record_of("thrust-map")
    assert len(read(gained)) == 9
    assert [float(row["required_a_max_m_s2"]) for row in read(gained, "required_a_max_m_s2")] == gained[
        "outputs"
    ]["required_a_max_m_s2"]


def test_objects_within_rows_are_a_table_of_their_own() -> None:
    outputs = {
        "windows": [
            {"span_min": [120.0, 125.0], "findings": [{"limit": 1.0, "case": None}, {"limit": 2.0}]},
            {"span_min": [0.0, 240.0], "findings": [{"limit": 3.0, "case": {"x_m": 5.0}}]},
        ]
    }
    found = tables_of(outputs)
    assert found["windows"] == [
        {"span_min.0": 120.0, "span_min.1": 125.0},
        {"span_min.0": 0.0, "span_min.1": 240.0},
    ]
    assert [row["findings.limit"] for row in found["windows.findings"]] == [1.0, 2.0, 3.0]
    assert found["windows.findings"][2] == {
        "span_min.0": 0.0,
        "span_min.1": 240.0,
        "findings.limit": 3.0,
        "findings.case.x_m": 5.0,
    }


def test_a_list_within_an_object_is_a_table_of_its_own() -> None:
    hops = [{"rho": 0.5, "impulse_m_s": [1.0, 2.0]}, {"rho": 0.7, "impulse_m_s": [3.0, 4.0]}]
    assert tables_of({"plan": {"orbits": 2.0, "hops": hops}}) == {
        "plan.hops": [
            {"rho": 0.5, "impulse_m_s.0": 1.0, "impulse_m_s.1": 2.0},
            {"rho": 0.7, "impulse_m_s.0": 3.0, "impulse_m_s.1": 4.0},
        ]
    }


def test_lists_of_which_nothing_is_said_are_no_table() -> None:
    assert tables_of({"x_m": [1.0, 2.0], "y_m": [1.0, 2.0], "mask": [[True, False]] * 2}) == {}
    assert tables_of({"a": [1]}, process("go-no-go").tables) == {}
    broken = {"x_m": [1.0], "y_m": [1.0], "mask": [[True]], "margin_m": [[1.0], [2.0]]}
    assert tables_of(broken, process("certificate").tables) == {}, "of another version"
    record = {"outputs": {"verdict": ["GO"], "margin_m": [1.0]}}
    with np.load(io.BytesIO(BY_NAME["npz"].encode(record, None)), allow_pickle=False) as found:
        assert set(found) == {"margin_m"}
