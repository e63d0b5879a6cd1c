"""What a result says, as digests by place: two results are the same where their digests are.

Left out are times and what the machine and the versions are. A picture counts by its name: its bytes hold the
version of the library that drew it, and what it shows stands in the arrays beside it.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping
from hashlib import sha256
from typing import Any

import numpy as np

from safestart.records.parquet import read

LEFT_OUT = frozenset({"run_s", "compile_s", "speedup_vs_hj", "provenance", "request_id"})
"""Keys for durations and for place, time and versions of the computation, at any depth."""
DEPTH = 4
"""Number of keys that identify a place; deeper values share one digest with their neighbours."""

Digests = dict[str, str]


def digest(parts: Iterable[str | bytes]) -> str:
    """The first 48 bits of a SHA-256 over the parts, each told from the next: a change is found, none is forged."""
    total = sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        total.update(f"{len(data)}:".encode() + data)
    return total.hexdigest()[:12]


def document(value: Any) -> Digests:
    """Digests of a JSON document: of each place, of all values, and of all values in their order as written.

    A place is a path of keys; the entries of a list share one, so that a column of a table has one digest.
    """
    value = comparable(value)
    places: dict[str, list[str]] = {}
    _walk(value, "", 0, places)
    sorted_text = json.dumps(value, sort_keys=True, separators=(",", ":"))
    return {
        **{place: digest(texts) for place, texts in places.items()},
        "(all)": digest([sorted_text]),
        "(order of keys)": digest([json.dumps(value, separators=(",", ":"))]),
    }


def comparable(value: Any) -> Any:
    """The document without uncomputed values."""
    if isinstance(value, dict):
        return {key: comparable(inner) for key, inner in value.items() if key not in LEFT_OUT}
    return [comparable(inner) for inner in value] if isinstance(value, list) else value


def _walk(value: Any, place: str, depth: int, places: dict[str, list[str]]) -> None:
    if isinstance(value, dict) and value and depth < DEPTH:
        for key, inner in value.items():
            _walk(inner, f"{place}.{key}" if place else key, depth + 1, places)
    elif isinstance(value, list) and any(isinstance(inner, dict | list) for inner in value):
        places.setdefault(place, []).append(f"list of {len(value)}")
        for inner in value:
            _walk(inner, place, depth, places)
    else:
        places.setdefault(place, []).append(json.dumps(value, sort_keys=True, separators=(",", ":")))


def file(name: str, data: bytes) -> Digests:
    """Digests of a file, by the ending of its name."""
    ending = name.rpartition(".")[2]
    readers = {"png": _picture, "npz": arrays, "parquet": parquet, "csv": table, "json": _json}
    return readers[ending](data) if ending in readers else {"bytes": digest([data])}


def _picture(data: bytes) -> Digests:
    return {"picture": "there" if data.startswith(b"\x89PNG\r\n\x1a\n") else "not a PNG"}


def _json(data: bytes) -> Digests:
    return document(json.loads(data))


def arrays(data: bytes) -> Digests:
    """One digest per array of an NPZ file, over its type, shape and bytes; not over the ZIP around them."""
    with np.load(io.BytesIO(data), allow_pickle=False) as found:
        return {name: _array(found[name]) for name in found.files if not _left_out(name)}


def _array(array: np.ndarray[Any, Any]) -> str:
    return digest([array.dtype.str, str(array.shape), np.ascontiguousarray(array).tobytes()])


def table(data: bytes) -> Digests:
    """One digest per column of a CSV file, over its written values."""
    rows = list(csv.reader(io.StringIO(data.decode(), newline="")))
    values = {
        name: [_cell(row[place]) if row[place].startswith("{") else row[place] for row in rows[1:]]
        for place, name in enumerate(rows[0])
    }
    return _columns(rows[0], values)


def parquet(data: bytes) -> Digests:
    """One digest per column of a Parquet file, over its type and values."""
    found = read(data)
    values = {
        field.name: [str(field.type), *map(_cell, found.column(field.name).to_pylist())]
        for field in found.schema
    }
    return _columns(found.column_names, values)


def _cell(value: Any) -> str:
    """A cell, without its times where it holds an object as text."""
    if isinstance(value, str) and value.startswith("{"):
        return json.dumps(comparable(json.loads(value)))
    return repr(value)


def _columns(names: list[str], values: Mapping[str, list[str]]) -> Digests:
    kept = [name for name in names if not _left_out(name)]
    return {**{name: digest(values[name]) for name in kept}, "(columns)": digest(kept)}


def _left_out(name: str) -> bool:
    return name.rpartition(".")[2] in LEFT_OUT
