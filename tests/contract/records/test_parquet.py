"""Reading Parquet starts no thread: one that holds Python's objects aborts the process when Python ends."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from safestart.records import parquet

COUNT = """
import io, os
import pyarrow as pa, pyarrow.parquet as pq
from safestart.records.parquet import read

def threads():
    return len(os.listdir("/proc/self/task"))

sink = io.BytesIO()
pq.write_table(pa.table({"a": list(range(1000))}), sink)
before = threads()
assert read(sink.getvalue())["a"].to_pylist() == list(range(1000))
print(before, threads())
"""


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="threads are counted in /proc")
def test_no_thread_is_left_that_holds_the_file() -> None:
    done = subprocess.run([sys.executable, "-c", COUNT], check=True, capture_output=True, text=True)
    before, after = done.stdout.split()
    assert after == before


def test_what_is_no_parquet_is_refused() -> None:
    with pytest.raises((pa.ArrowException, OSError)):
        parquet.read(b"PAR1 and nothing else")


def test_columns_types_and_row_groups_are_those_of_the_file() -> None:
    table = pa.table({"n": pa.array([1, None, 3], pa.int32()), "t": ["a", "b", None]})
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, row_group_size=2)
    assert parquet.read(sink.getvalue().to_pybytes()) == table
