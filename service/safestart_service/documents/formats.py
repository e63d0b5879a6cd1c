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
from safestart.processes.base import Table
from safestart.processes.registry import PROCESS_IDS, process
from safestart_service.documents.tables import Rows, columns_of, tables_of
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


def encoded(record: dict[str, Any], kind: str, table: str | None) -> bytes:
    """A record as ``kind``; raises ``InvalidInput``, ``NotAcceptable``, ``Unavailable``."""
    outputs = record["outputs"]
    if kind in JSON:
        return orjson.dumps(record if kind == RECORD else ogc_results(record))
    if kind == NPZ:
        return npz_file(outputs)
    rows = chosen_table(tables_of(outputs, _declared(record)), table)
    return csv_file(rows) if kind == CSV else parquet_file(rows)


def tag_of(kind: str, table: str | None) -> str:
    """What tells this form's entity tag from the record's."""
    return "" if kind == RECORD else f"-{NAME[kind]}-{sha256((table or '').encode()).hexdigest()[:8]}"


def ogc_values(outputs: dict[str, Any]) -> dict[str, Any]:
    """Outputs as the standard has them: objects qualified; those without a value left out, as it knows no null."""
    return {
        name: {"value": value, "mediaType": "application/json"} if isinstance(value, dict) else value
        for name, value in outputs.items()
        if value is not None
    }


def ogc_results(record: dict[str, Any]) -> dict[str, Any]:
    """The results document of OGC API - Processes 1.0: values by output id, artifacts as links."""
    document = ogc_values(record["outputs"])
    for file in record["artifacts"]:
        document[file["name"]] = {"href": file["href"], "type": file["media_type"], "title": file["name"]}
    return document


def chosen_table(found: dict[str, Rows], name: str | None) -> Rows:
    """The table of this name, or the first one; raises ``InvalidInput`` or ``NotAcceptable``."""
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
    writer = csv.DictWriter(text, columns_of(rows), lineterminator="\r\n")
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
    columns = {name: _uniform([row.get(name) for row in rows]) for name in columns_of(rows)}
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
        for column in columns_of(rows):
            if (array := _numeric([row[column] for row in rows])) is not None:
                arrays[f"{name}.{column}"] = array
    sink = io.BytesIO()
    np.savez_compressed(sink, **arrays)
    return sink.getvalue()


def _declared(record: dict[str, Any]) -> tuple[Table, ...]:
    """What the process says of its lists; nothing where it is gone."""
    process_id = record.get("process", {}).get("id")
    return process(process_id).tables if process_id in PROCESS_IDS else ()


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


def _uniform(values: list[Any]) -> list[Any]:
    """A column of one type: whole numbers among others become floats, and whatever else is mixed, text."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        return [None if value is None else float(value) for value in values]
    if len(kinds) > 1:
        return [None if value is None else str(value) for value in values]
    return values
