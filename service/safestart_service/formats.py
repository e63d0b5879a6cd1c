"""A stored result in the forms it is asked for: our record, the standard's document, CSV, NPZ, Parquet.

NumPy and pyarrow are loaded with the first file that needs them.
"""

from __future__ import annotations

import csv
import io
from hashlib import sha256
from typing import Any

import orjson

from safestart.errors import Unavailable, invalid
from safestart_service.errors import NotAcceptable

RECORD = "application/vnd.safestart.result+json"
OGC = "application/json"
CSV = "text/csv"
NPZ = "application/x-npz"
PARQUET = "application/vnd.apache.parquet"
OFFERED = (RECORD, OGC, CSV, NPZ, PARQUET)
"""In order of preference: who takes anything gets the record."""
BY_NAME = {"record": RECORD, "ogc": OGC, "csv": CSV, "npz": NPZ, "parquet": PARQUET}

NAME = {kind: name for name, kind in BY_NAME.items()}
JSON = (RECORD, OGC)

Rows = list[dict[str, Any]]


def encoded(record: dict[str, Any], kind: str, table: str | None) -> bytes:
    """A record as ``kind``; raises ``InvalidInput``, ``NotAcceptable``, ``Unavailable``."""
    outputs = record["outputs"]
    if kind in JSON:
        return orjson.dumps(record if kind == RECORD else ogc_results(record))
    if kind == NPZ:
        return npz_file(outputs)
    rows = chosen_table(outputs, table)
    return csv_file(rows) if kind == CSV else parquet_file(rows)


def tag_of(kind: str, table: str | None) -> str:
    """What tells this form's entity tag from the record's."""
    return "" if kind == RECORD else f"-{NAME[kind]}-{sha256((table or '').encode()).hexdigest()[:8]}"


def ogc_results(record: dict[str, Any]) -> dict[str, Any]:
    """The results document of OGC API - Processes 1.0: values by output id, objects qualified, artifacts as links.

    An output without a value (null) is left out, as the standard's values know no null.
    """
    document: dict[str, Any] = {}
    for name, value in record["outputs"].items():
        if isinstance(value, dict):
            document[name] = {"value": value, "mediaType": "application/json"}
        elif value is not None:
            document[name] = value
    for file in record["artifacts"]:
        document[file["name"]] = {"href": file["href"], "type": file["media_type"], "title": file["name"]}
    return document


def tables_of(outputs: dict[str, Any]) -> dict[str, Rows]:
    """The tables among outputs: lists of objects by name; without any, lists of equal length side by side as one."""
    found = {
        name: [_flat(row) for row in value]
        for name, value in outputs.items()
        if isinstance(value, list) and value and all(isinstance(row, dict) for row in value)
    }
    if found:
        return found
    columns = {
        name: value
        for name, value in outputs.items()
        if isinstance(value, list) and value and not any(isinstance(item, list | dict) for item in value)
    }
    if columns and len({len(column) for column in columns.values()}) == 1:
        names = list(columns)
        return {
            "outputs": [dict(zip(names, row, strict=True)) for row in zip(*columns.values(), strict=True)]
        }
    return {}


def chosen_table(outputs: dict[str, Any], name: str | None) -> Rows:
    """The table of this name, or the first one; raises ``InvalidInput`` or ``NotAcceptable``."""
    found = tables_of(outputs)
    if not found:
        raise NotAcceptable(
            "this result holds no table; required application/json or application/x-npz",
            field="Accept",
            required="application/json or application/x-npz",
        )
    if name is None:
        return next(iter(found.values()))
    if name not in found:
        raise invalid("table", f"one of {', '.join(found)}", name)
    return found[name]


def csv_file(rows: Rows) -> bytes:
    """RFC 4180, with a header line; what has no value is empty."""
    text = io.StringIO()
    writer = csv.DictWriter(text, _columns(rows), lineterminator="\r\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()


def parquet_file(rows: Rows) -> bytes:
    """One row group; raises ``Unavailable`` where pyarrow is not installed."""
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ModuleNotFoundError:
        raise Unavailable(
            "Parquet requires the package pyarrow, which is not installed here",
            required="the package pyarrow",
        ) from None
    sink = io.BytesIO()
    columns = {name: _uniform([row.get(name) for row in rows]) for name in _columns(rows)}
    pq.write_table(pa.table(columns), sink)
    return sink.getvalue()


def npz_file(outputs: dict[str, Any]) -> bytes:
    """Every numeric output as an array; columns of tables as ``table.column``, without value: NaN."""
    import numpy as np

    arrays: dict[str, Any] = {}
    for name, value in outputs.items():
        if isinstance(value, int | float | list) and (array := _numeric(value)) is not None:
            arrays[name] = array
    for name, rows in tables_of(outputs).items():
        for column in _columns(rows):
            if name != "outputs" and (array := _numeric([row.get(column) for row in rows])) is not None:
                arrays[f"{name}.{column}"] = array
    sink = io.BytesIO()
    np.savez_compressed(sink, **arrays)
    return sink.getvalue()


def _flat(row: dict[str, Any]) -> dict[str, Any]:
    """The scalars of a row, those of inner objects as ``name.member``; a list of short words as one text."""
    found: dict[str, Any] = {}
    for name, value in row.items():
        if isinstance(value, dict):
            found.update({f"{name}.{key}": item for key, item in _flat(value).items()})
        elif not isinstance(value, list):
            found[name] = value
        elif all(isinstance(item, str) for item in value):
            found[name] = " ".join(value)
    return found


def _numeric(value: Any) -> Any:
    """An array of numbers or truth values, None for what is none (text, ragged lists)."""
    import numpy as np

    try:
        array = np.array(value)
        if array.dtype == object:
            array = np.array(value, dtype=np.float64)  # None becomes NaN
    except (TypeError, ValueError):
        return None
    return array if array.dtype.kind in "biuf" else None


def _columns(rows: Rows) -> list[str]:
    return list(dict.fromkeys(name for row in rows for name in row))


def _uniform(values: list[Any]) -> list[Any]:
    """A column of one type: whole numbers among others become floats, and whatever else is mixed, text."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        return [None if value is None else float(value) for value in values]
    if len(kinds) > 1:
        return [None if value is None else str(value) for value in values]
    return values
