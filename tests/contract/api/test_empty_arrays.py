"""An empty list of points is an array without rows, of points all the same, in every format of a result."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat

from safestart.processes.execute import execute
from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.tables import typed_tables
from safestart.processes.tables.columns import output_arrays
from safestart.records import parquet
from safestart_service.documents.formats.npz import arrays_of
from safestart_service.documents.formats.registry import BY_NAME

EMPTY = {"omega_t_deg_s": 30, "a_max_m_s2": 0.001}
WHOLE = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1}


def test_an_empty_region_has_the_columns_of_another() -> None:
    empty, whole = (execute("safe-region", inputs).document for inputs in (EMPTY, WHOLE))
    for polygon in ("inner_polygon_m", "outer_polygon_m"):
        assert empty["outputs"][polygon] == []
        assert len(whole["outputs"][polygon]) > 2
        for record in (empty, whole):
            rows = len(record["outputs"][polygon])
            with np.load(io.BytesIO(BY_NAME["npz"].encode(record, None))) as found:
                assert found[polygon].shape == (rows, 2)
                assert found[f"{polygon}.{polygon}.0"].shape == (rows,)
            assert loadmat(io.BytesIO(BY_NAME["mat"].encode(record, None)))[polygon].shape == (rows, 2)
            table = BY_NAME["csv"].encode(record, polygon).decode()
            assert next(csv.reader(io.StringIO(table))) == [f"{polygon}.0", f"{polygon}.1"]
            columnar = parquet.read(BY_NAME["parquet"].encode(record, polygon))
            assert (columnar.column_names, columnar.num_rows) == ([f"{polygon}.0", f"{polygon}.1"], rows)
    assert {name: array.dtype for name, array in arrays_of(empty).items()} == {
        name: array.dtype for name, array in arrays_of(whole).items()
    }


@pytest.mark.parametrize("process_id", PROCESS_IDS)
def test_every_output_has_its_axes(process_id: str) -> None:
    spec = process(process_id)
    outputs: dict[str, Any] = {name: [] if one.shape else 0 for name, one in output_arrays(spec).items()}
    record = {"process": {"id": spec.id, "version": spec.version}, "outputs": outputs}
    assert typed_tables(record) is not None
    arrays = arrays_of(record)
    for name, one in output_arrays(spec).items():
        assert arrays[name].ndim == len(one.shape), name
        assert arrays[name].shape[1:] == one.shape[1:], name
