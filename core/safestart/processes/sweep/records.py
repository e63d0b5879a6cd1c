"""Per-case records as Parquet: written by each shard, joined by the merge."""

from __future__ import annotations

import io
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from safestart.processes.sweep.judge import GO, UNASKED
from safestart.processes.sweep.spec import SweepInputs

if TYPE_CHECKING:
    from safestart.processes.sweep.cases import Cases
    from safestart.processes.sweep.shard import Flown, Verdict

MEDIA_TYPE = "application/vnd.apache.parquet"


def schema(inputs: SweepInputs) -> pa.Schema:
    """Columns: the start, one verdict per certificate (null: not asked), what each controller flew."""
    fields = [pa.field("case", pa.int64())]
    fields += [pa.field(name, pa.float64()) for name in ("omega_t_deg_s", "a_max_m_s2", "x_m", "y_m")]
    fields += [pa.field(f"certified_{name}", pa.bool_()) for name in inputs.certificates]
    for name in inputs.controllers:
        fields.append(pa.field(f"safe_{name}", pa.bool_()))
        fields += [
            pa.field(f"{column}_{name}", pa.float64())
            for column in ("margin_m", "violated_at_s", "delta_v_m_s")
        ]
        fields += [pa.field(f"{column}_{name}", pa.int32()) for column in ("steps", "fallbacks")]
    return pa.schema(fields)


def parquet(inputs: SweepInputs, rows: list[tuple[Cases, Verdict, Flown, int]]) -> bytes:
    """The first cases of each group as one Parquet file; empty bytes without any."""
    if not rows:
        return b""
    columns: dict[str, list[Any]] = {name: [] for name in schema(inputs).names}
    for cases, verdicts, flown, count in rows:
        columns["case"].append(cases.numbers[:count])
        columns["omega_t_deg_s"].append(np.full(count, cases.omega_t_deg_s))
        columns["a_max_m_s2"].append(np.full(count, cases.a_max_m_s2))
        columns["x_m"].append(cases.points[:count, 0])
        columns["y_m"].append(cases.points[:count, 1])
        for name, verdict in verdicts.items():
            columns[f"certified_{name}"].append(
                np.ma.masked_array(verdict[:count] == GO, verdict[:count] == UNASKED)
            )
        for name, outcome in flown.items():
            late = outcome.violated_at[:count]
            columns[f"safe_{name}"].append(outcome.safe[:count])
            columns[f"margin_m_{name}"].append(outcome.margin[:count])
            columns[f"violated_at_s_{name}"].append(np.ma.masked_array(late, ~np.isfinite(late)))
            columns[f"delta_v_m_s_{name}"].append(outcome.delta_v[:count])
            columns[f"steps_{name}"].append(outcome.steps[:count])
            columns[f"fallbacks_{name}"].append(outcome.fallbacks[:count])
    arrays = [_array(columns[field.name], field.type) for field in schema(inputs)]
    return _written([pa.Table.from_arrays(arrays, schema=schema(inputs))], schema(inputs))


def joined(inputs: SweepInputs, files: Iterable[bytes]) -> bytes:
    """One file from those of the shards, a row group each; read and written one at a time."""
    tables = (pq.read_table(io.BytesIO(data)) for data in files if data)
    return _written(tables, schema(inputs))


def _array(parts: list[Any], kind: pa.DataType) -> pa.Array:
    values: Any = np.ma.concatenate(parts)
    return pa.array(np.ma.getdata(values), type=kind, mask=np.ma.getmaskarray(values))


def _written(tables: Iterable[pa.Table], columns: pa.Schema) -> bytes:
    buffer = io.BytesIO()
    with pq.ParquetWriter(buffer, columns, compression="zstd") as writer:
        for table in tables:
            writer.write_table(table)
    return buffer.getvalue()
