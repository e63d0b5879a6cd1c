"""Parquet is read in the thread that asks for it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pyarrow as pa


def read(data: bytes, dictionaries: Sequence[str] = ()) -> pa.Table:
    """The table of a Parquet file; columns named in ``dictionaries`` stay dictionaries.

    Raises ``pyarrow.ArrowException`` or ``OSError`` where it is none.

    ``pyarrow.parquet.read_table`` leaves Python's file to a thread of Arrow. Where that thread lets it go while Python
    ends, the whole process aborts, after its answer was printed: of flight studies on a busy machine one in ten did.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    return pq.ParquetFile(pa.BufferReader(data), read_dictionary=list(dictionaries)).read(use_threads=False)
