"""Tables of every process: columns and types come from its models, so that any two of its results are read together.

For each process two results are made of its models: one with everything that may be absent, empty or null left out,
one with all of it.
"""

from __future__ import annotations

import csv
import io
import types
from enum import Enum
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import duckdb
import numpy as np
import pandas as pd
import polars as pl
import pyarrow.dataset as ds
import pyarrow.parquet as pq
import pytest
from annotated_types import Ge, Gt, MaxLen, MinLen
from pydantic import BaseModel
from scipy.io import loadmat

from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.tables import Kind, typed_tables
from safestart.processes.tables.columns import columns_of
from safestart_service.documents.formats.registry import BY_NAME

WITH_TABLES = [name for name in PROCESS_IDS if columns_of(process(name))]


def made(annotation: Any, *, full: bool) -> Any:
    """A value of a type: the barest, or one with everything in it."""
    if get_origin(annotation) is Annotated:
        kind, *constraints = get_args(annotation)
        flat = [part for item in constraints for part in (getattr(item, "metadata", None) or (item,))]
        least = max((part.min_length for part in flat if isinstance(part, MinLen)), default=0)
        value = made(kind, full=full)
        if isinstance(value, list) and least:
            inner = get_args(kind)[0]
            most = min((part.max_length for part in flat if isinstance(part, MaxLen)), default=least)
            return [made(inner, full=full) for _ in range(most if full else least)]
        bounds = [part for part in flat if isinstance(part, Gt | Ge)]
        return value + 1 if bounds and not isinstance(value, bool) else value
    if get_origin(annotation) in (Union, types.UnionType):
        kinds = get_args(annotation)
        if types.NoneType in kinds and not full:
            return None
        return made(next(kind for kind in kinds if kind is not types.NoneType), full=full)
    if get_origin(annotation) is Literal:
        return get_args(annotation)[0]
    if get_origin(annotation) is list:
        return [made(get_args(annotation)[0], full=True)] if full else []
    if get_origin(annotation) is dict:
        names, inner = get_args(annotation)
        keys = get_args(names) if get_origin(names) is Literal else ("some",)
        return {key: made(inner, full=True) for key in keys} if full else {}
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return {
            name: made(
                Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation,
                full=full,
            )
            for name, field in annotation.model_fields.items()
            if full or field.is_required()
        }
    if isinstance(annotation, type) and issubclass(annotation, Enum):
        return next(iter(annotation)).value
    return {bool: True, int: 2, float: 0.5, str: "a word", Any: {"deep": [1, None]}}[annotation]


def record(name: str, *, full: bool) -> dict[str, Any]:
    spec = process(name)
    outputs = made(spec.outputs, full=full)
    if not full:  # a row of each list of objects, whose own parts are absent
        for key, field in spec.outputs.model_fields.items():
            if get_origin(field.annotation) is list:
                row = made(get_args(field.annotation)[0], full=False)
                outputs[key] = [row] if isinstance(row, dict) else []
    return {"process": {"id": name, "version": spec.version}, "outputs": outputs}


def parquet(name: str, table: str, *, full: bool) -> bytes:
    return BY_NAME["parquet"].encode(record(name, full=full), table)


def test_most_processes_have_tables_and_the_made_results_fit_them() -> None:
    assert len(WITH_TABLES) >= 20
    for name in ("benchmark", "sweep", "passive-safety", "flight", "inclusion-chain"):
        process(name).check(record(name, full=True)["outputs"])


@pytest.mark.parametrize("name", WITH_TABLES)
def test_any_two_results_of_a_process_are_read_together(name: str, tmp_path: Path) -> None:
    bare, full = typed_tables(record(name, full=False)), typed_tables(record(name, full=True))
    assert list(bare) == list(full)
    for table, typed in full.items():
        assert bare[table].kinds == typed.kinds
        files = []
        for which in (False, True):
            files.append(tmp_path / f"{table}.{which}.parquet")
            files[-1].write_bytes(parquet(name, table, full=which))
        schemas = [pq.read_schema(file) for file in files]
        assert schemas[0] == schemas[1], table
        assert not any(str(kind) == "null" for kind in schemas[0].types)
        together = bare[table].rows + typed.rows
        for order in (files, files[::-1]):
            names = [str(file) for file in order]
            assert ds.dataset(names).to_table().num_rows == together
            joined = duckdb.read_parquet(names)  # by position and without casts, unless told otherwise
            assert len(joined.fetchall()) == together
            assert joined.columns == list(typed.kinds)
            assert joined.types == duckdb.read_parquet(names[:1]).types
        assert pl.concat([pl.read_parquet(file) for file in files], how="vertical").height == together
        frames = [pd.read_parquet(file) for file in files]
        assert len(pd.concat(frames)) == together
        lines = [
            list(csv.reader(io.StringIO(BY_NAME["csv"].encode(record(name, full=which), table).decode())))
            for which in (False, True)
        ]
        assert lines[0][0] == lines[1][0] == list(typed.kinds)
        assert sum(len(one) - 1 for one in lines) == together


@pytest.mark.parametrize("name", PROCESS_IDS)
def test_arrays_have_the_same_names_and_types(name: str) -> None:
    """NPZ and MATLAB: a column without a value is there, as NaN or empty."""
    found = []
    for full in (False, True):
        with np.load(
            io.BytesIO(BY_NAME["npz"].encode(record(name, full=full), None)), allow_pickle=False
        ) as arrays:
            found.append({key: arrays[key].dtype for key in arrays.files})
        matlab = loadmat(io.BytesIO(BY_NAME["mat"].encode(record(name, full=full), None)))
        assert {key for key in matlab if not key.startswith("__")} == {
            key.replace(".", "__")[:63] for key in found[-1]
        }
    assert found[0] == found[1]


def test_what_the_paper_prints_and_matrices_are_columns_of_every_benchmark() -> None:
    kinds = typed_tables(record("benchmark", full=False))["rows"].kinds
    assert kinds["published.iou_vs_hj"] is Kind.NUMBER
    assert kinds["confusion.tp"] is Kind.INTEGER
    assert kinds["detail"] is Kind.TEXT
    assert kinds["cells"] is Kind.INTEGER


def test_results_of_another_version_are_read_by_their_values() -> None:
    old = {"process": {"id": "coverage", "version": "0.0.1"}, "outputs": {"cells": [{"gone": 1, "r0": None}]}}
    assert typed_tables(old)["cells"].kinds == {"gone": Kind.INTEGER, "r0": Kind.NUMBER}
