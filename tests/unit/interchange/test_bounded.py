"""Small files that unpack to large ones, and files of many small parts: refused before they cost memory or time."""

import contextlib
import io
import resource
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from safestart.errors import InvalidInput
from safestart.interchange.read import ephemeris_from
from safestart.interchange.tables.matlab_read import arrays_in
from safestart.interchange.write import course_bytes
from tests.unit.interchange.sample import CREATED, course

MB = 1_000_000
HEAD = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM"
XML = b'<oem id="CCSDS_OEM_VERS" version="2.0">%b</oem>'


def _parquet(rows: int, text: str) -> bytes:
    """Many rows, or long texts, in a few bytes."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    sink = io.BytesIO()
    columns = {name: pa.array(np.zeros(rows)) for name in ("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s")}
    texts = {
        name: pa.array([text] * rows) for name in ("epoch", "object", "object_id", "frame", "time_system")
    }
    pq.write_table(pa.table(columns | texts), sink)
    return sink.getvalue()


def _zeros(count: int) -> bytes:
    """A packed matrix of zeros."""
    plain = struct.pack("<II", 14, 56 + count * 8) + struct.pack("<IIII", 6, 8, 6, 0)
    plain += struct.pack("<IIii", 5, 8, count, 1) + struct.pack("<II3s5x", 1, 3, b"x_m")
    packer = zlib.compressobj()
    packed = packer.compress(plain + struct.pack("<II", 9, count * 8))
    packed += b"".join(packer.compress(bytes(MB)) for _ in range(count * 8 // MB)) + packer.flush()
    return HEAD + struct.pack("<II", 15, len(packed)) + packed


def _nested(levels: int) -> bytes:
    """Cells in cells."""
    level = struct.pack("<IIII", 6, 8, 1, 0) + struct.pack("<IIii", 5, 8, 1, 1)
    body = b"".join(
        struct.pack("<II", 14, 48 * (levels - k) - 8) + level + struct.pack("<II", 1, 0)
        for k in range(levels)
    )
    return HEAD + body


BOMBS = {
    "rows.parquet": lambda: _parquet(1_100_000, "2026-01-01T00:00:00"),
    "texts.parquet": lambda: _parquet(20, "9" * MB),
    "zeros.mat": lambda: _zeros(35 * MB),
    "cells.mat": lambda: _nested(100_000),
    "tags.xml": lambda: XML % (b"<a/>" * 7 * MB),
    "attributes.xml": lambda: XML.replace(b">%b", b"%b>") % b"".join(b' a%d=""' % k for k in range(200_000)),
    "lines.oem": lambda: b"CCSDS_OEM_VERS = 2.0\n" + b"1\n" * 3 * MB,
    "breaks.oem": lambda: b"CCSDS_OEM_VERS = 2.0\n" + b"\x0b" * 3 * MB,
    "rows.csv": lambda: b"a,b\n" + b"1,\n" * 2 * MB,
    "columns.csv": lambda: b"," * 20 * MB,
    "value.csv": lambda: b"epoch,x_m\n" + b"1" * 200_000 + b",2\n",
    "quoted.csv": lambda: b'epoch,x_m\n"' + b"\n" * 1000,
}


@pytest.mark.parametrize("name", BOMBS)
def test_a_bomb_is_refused_unexploded(name: str, tmp_path: Path) -> None:
    """In a process of its own with 1 GB and 20 s of processor time."""
    path = tmp_path / name
    path.write_bytes(BOMBS[name]())
    assert path.stat().st_size < 64 * 1024 * 1024
    code = (
        "import sys\n"
        "from safestart.errors import InvalidInput\n"
        "from safestart.interchange.read import attitude_of, ephemeris_of\n"
        "import pyarrow.parquet, defusedxml.ElementTree\n"
        "for read in (ephemeris_of, attitude_of):\n"
        "    try: read(sys.argv[1])\n"
        "    except InvalidInput as error: print(len(error.detail) < 2000 and 'required' in error.detail)\n"
        "peak = [line for line in open('/proc/self/status') if line.startswith('VmHWM')][0]\n"
        "print(int(peak.split()[1]) < 1_000_000)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(path)],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (20, 20)),
    )
    assert (done.returncode, done.stdout.split()) == (0, ["True"] * 3), done.stderr[-500:]


@pytest.mark.parametrize("packed", [True, False])
def test_matlab_arrays_of_every_type_are_those_of_scipy(packed: bool) -> None:
    rng = np.random.default_rng(5)
    numbers = {
        f"n_{kind}": (100 * rng.random((3, 4))).astype(kind)
        for kind in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8")
    }
    given = numbers | {
        "one": "hello",
        "rows": np.array(["ab", "cde"]),
        "cells": np.array(["x", "yü", "€uro", ""], dtype=object),
        "none": np.zeros((0, 0)),
    }
    sink = io.BytesIO()
    savemat(sink, given, do_compression=packed)
    found = arrays_in(sink.getvalue(), 100)
    for name, array in numbers.items():
        assert found[name] == array.astype(float).ravel().tolist()
    assert (found["one"], found["rows"]) == (["hello"], ["ab", "cde"])
    assert (found["cells"], found["none"]) == (["x", "yü", "€uro", ""], [])


@pytest.mark.parametrize(
    ("array", "received"),
    [
        (np.array([1j]), "complex numbers"),
        ({"a": 1}, "a structure"),
        (np.array([np.array(["a"], dtype=object), 1], dtype=object), "cells of something else"),
        (np.zeros(200), "200"),
    ],
)
def test_matlab_arrays_that_are_refused(array: object, received: str) -> None:
    sink = io.BytesIO()
    savemat(sink, {"x_m": array})
    with pytest.raises(InvalidInput, match=f"x_m: required .*{received}"):
        arrays_in(sink.getvalue(), 100)


@pytest.mark.parametrize("form", ["mat", "parquet", "csv", "xml", "kvn"])
def test_damaged_files_are_refused_or_read(form: str) -> None:
    data = course_bytes(course(count=5), form, CREATED)
    rng = np.random.default_rng(7)
    for _ in range(300):
        bad = bytearray(data[: rng.integers(len(data)) if rng.random() < 0.3 else None])
        for at in rng.integers(0, max(len(bad), 1), 3):
            bad[at : at + 1] = bytes([rng.integers(256)])
        with contextlib.suppress(InvalidInput):
            ephemeris_from(bytes(bad), f"a.{form}")
