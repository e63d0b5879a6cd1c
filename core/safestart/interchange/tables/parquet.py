"""Parquet tables in and out; what they unpack to is bounded before it is unpacked."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any

from safestart.errors import Unavailable, invalid
from safestart.records.parquet import read

_LONGEST_TEXT = 200
"""Characters of an epoch or a name."""


def parquet_of(columns: Mapping[str, Sequence[Any]]) -> bytes:
    """Parquet; raises ``Unavailable`` without pyarrow."""
    pa, pq = _arrow()
    sink = io.BytesIO()
    pq.write_table(pa.table({name: list(column) for name, column in columns.items()}), sink)
    return sink.getvalue()


def columns_in(data: bytes, known: Sequence[str], most: int) -> dict[str, list[Any]]:
    """The columns, by name, of numbers or of texts.

    A file of a megabyte can unpack to thousands: its rows and columns are counted first, and texts stay in their
    dictionary until their lengths are known. Raises ``InvalidInput`` for anything but Parquet, for more than ``most``
    rows, columns not among ``known``, other types and long texts.
    """
    pa, pq = _arrow()
    try:
        file = pq.ParquetFile(pa.BufferReader(data))
        names, rows = list(file.schema_arrow.names), file.metadata.num_rows
        if rows > most:
            raise invalid("file", f"at most {most} rows", rows)
        if len(set(names)) != len(names) or set(names) - set(known):
            raise invalid("file", f"columns among {', '.join(known)}, each once", names[: len(known) + 1])
        texts = [field.name for field in file.schema_arrow if _is_text(pa, field.type)]
        table = read(data, texts)
        return {name: _plain(pa, name, table.column(name)) for name in names}
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise invalid("file", "Parquet", str(error)) from None


def _is_text(pa: Any, kind: Any) -> bool:
    return bool(pa.types.is_string(kind) or pa.types.is_large_string(kind))


def _plain(pa: Any, name: str, column: Any) -> list[Any]:
    kind = column.type
    if pa.types.is_dictionary(kind) and _is_text(pa, kind.value_type):
        for chunk in column.chunks:
            longest = max((len(text) for text in chunk.dictionary.to_pylist() if text is not None), default=0)
            if longest > _LONGEST_TEXT:
                raise invalid(name, f"texts of at most {_LONGEST_TEXT} characters", longest)
    elif not (pa.types.is_floating(kind) or pa.types.is_integer(kind)):
        raise invalid(name, "numbers or texts", str(kind))
    found: list[Any] = column.to_pylist()
    return found


def _arrow() -> tuple[Any, Any]:
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ModuleNotFoundError:
        raise Unavailable("Parquet requires the package pyarrow", required="the package pyarrow") from None
    return pa, pq
