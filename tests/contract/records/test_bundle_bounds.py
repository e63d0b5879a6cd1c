"""A small bundle cannot ask for much memory: bounds hold before anything is unpacked, parsed or reported on."""

from __future__ import annotations

import io
import json
import tracemalloc
import zipfile
from hashlib import sha256

import numpy as np
import pytest

from safestart.errors import InvalidInput
from safestart.records.artifact import Artifact
from safestart.records.bundle import unpack
from safestart_service.documents.arrays import arrays_of
from tests.contract.records.test_hostile_bundles import EVENT, JOB, sealed

MOST_MEMORY = 200e6


def packed(compression: int = zipfile.ZIP_DEFLATED, **files: bytes) -> bytes:
    """A bundle of a sound job in which ``files`` stand in the place of others; its manifest fits them."""
    with zipfile.ZipFile(io.BytesIO(sealed())) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    parts |= {name.replace("__", "."): data for name, data in files.items()}
    manifest = json.loads(parts.pop("manifest.json"))
    manifest["files"] = {
        name: {"sha256": sha256(data).hexdigest(), "size": len(data)} for name, data in parts.items()
    }
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", compression) as archive:
        for name, data in (parts | {"manifest.json": json.dumps(manifest).encode()}).items():
            archive.writestr(name, data)
    return target.getvalue()


def refusal(data: bytes) -> str:
    """Why a bundle is refused; the memory that it takes is bounded."""
    tracemalloc.start()
    try:
        with pytest.raises(InvalidInput) as found:
            unpack(data)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < MOST_MEMORY, f"{peak / 1e6:.0f} MB"
    return found.value.detail


def test_zeros_are_refused_before_they_are_unpacked() -> None:
    data = packed(index__html=bytes(100_000_000))
    assert len(data) < 200_000
    assert "unpacks to more than 67108864 bytes" in refusal(data)


def test_a_small_bundle_may_unpack_to_much_more() -> None:
    assert unpack(packed(index__html=bytes(10_000_000))).job == JOB


@pytest.mark.parametrize("name", ["events__json", "job__json", "result__json"])
def test_millions_of_empty_objects_are_refused_before_they_are_parsed(name: str) -> None:
    data = packed(**{name: b"[" + b"{}," * 3_000_000 + b"{}]"})
    assert len(data) < 30_000
    assert f"{name.replace('__', '.')} holds more than" in refusal(data)


def test_only_the_first_wrong_event_is_reported() -> None:
    events = json.dumps([EVENT, *[{}] * 60_000]).encode()
    assert len(refusal(packed(events__json=events))) < 500


@pytest.mark.parametrize("opening", ["[", '{"a":'])
def test_deep_nesting_is_refused(opening: str) -> None:
    closing = "]" if opening == "[" else "}"
    depth = 50_000
    document = json.dumps(JOB)[:-1] + ', "x": ' + opening * depth + "1" + closing * depth + "}"
    assert "job.json is not JSON" in refusal(packed(job__json=document.encode()))


def test_a_text_of_tens_of_millions_of_letters_is_refused() -> None:
    assert "unpacks to more than" in refusal(packed(job__json=b'{"id": "' + b"a" * 80_000_000 + b'"}'))


def test_many_files_are_refused() -> None:
    assert "more than 1000 files" in refusal(packed(**{f"artifacts/{number}": b"" for number in range(1001)}))


@pytest.mark.parametrize("compression", [zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2])
def test_other_compressions_are_refused(compression: int) -> None:
    """An LZMA header alone may ask for 4 GB."""
    assert "packed in another way" in refusal(packed(compression))


def test_a_size_that_lies_is_refused() -> None:
    data = bytearray(packed(index__html=bytes(50_000_000)))
    place = data.rindex(b"index.html") - 46 + 24  # its entry in the central directory
    assert int.from_bytes(data[place : place + 4], "little") == 50_000_000
    data[place : place + 4] = (100).to_bytes(4, "little")
    assert "cannot be unpacked" in refusal(bytes(data))


def npz(name: str, content: bytes) -> Artifact:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, content)
    return Artifact("maps.npz", "application/x-npz", target.getvalue())


def npy(array: np.ndarray) -> bytes:
    target = io.BytesIO()
    np.save(target, array)
    return target.getvalue()


def refused_arrays(file: Artifact) -> str:
    tracemalloc.start()
    try:
        with pytest.raises(InvalidInput) as found:
            arrays_of(file, None)
        assert tracemalloc.get_traced_memory()[1] < MOST_MEMORY
    finally:
        tracemalloc.stop()
    return found.value.detail


def test_arrays_of_zeros_are_refused_before_they_are_unpacked() -> None:
    file = npz("mask.npy", npy(np.zeros(10_000_000)))
    assert len(file.data) < 100_000
    assert "at most 1000000 numbers in all" in refused_arrays(file)


@pytest.mark.parametrize(
    "content",
    [
        npy(np.zeros(4)).replace(b"(4,)", b"(4000000000000,)").replace(b" " * 13, b"", 1),
        npy(np.zeros(4)).replace(b"(4,)", b"(-4,)").replace(b"), }", b"),}", 1),
        npy(np.zeros(4))[:50],
        b"\x93NUMPY\x01\x00",
        b"no array",
        b"",
        npy(np.array([{}], dtype=object)),
    ],
)
def test_arrays_whose_headers_lie_are_refused(content: bytes) -> None:
    assert "a file that cannot be read" in refused_arrays(npz("mask.npy", content))


def test_a_member_that_is_no_array_is_refused() -> None:
    assert "a file that cannot be read" in refused_arrays(npz("mask", b"text"))
    lone = Artifact("maps.npz", "application/x-npz", npy(np.zeros(3)))
    assert "a file that cannot be read" in refused_arrays(lone)


def test_arrays_are_read_as_ever() -> None:
    file = npz("mask.npy", npy(np.array([[1.0, np.nan], [np.inf, 2.0]])))
    assert arrays_of(file, "mask") == {"mask": [[1.0, None], [None, 2.0]]}
