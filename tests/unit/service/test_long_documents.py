"""Long answers: their text is made piece by piece, and lies in a file as long as there is room for it."""

from __future__ import annotations

import os
import resource
import signal
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import orjson
import pytest

from safestart.processes.registry import process
from safestart.runtime.progress import Context
from safestart_service.computing.long_answers import LONG_BYTES, Place, Where, put
from safestart_service.computing.pieces import BLOCK, members, pieces

DOCUMENTS: list[Any] = [
    {},
    [],
    "x",
    None,
    1.5,
    {"a": 1},
    {"a": {}, "b": {"c": [0.1] * (BLOCK + 1)}, "d": []},
    [1] * BLOCK,
    [[1, 2.5]] * (2 * BLOCK + 3),
    {'\u00e9 " \\': ["\u2028"] * (2 * BLOCK)},
]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda one: str(one)[:30])
def test_the_pieces_are_the_document(document: Any) -> None:
    before = orjson.dumps(document)
    assert b"".join(pieces(document)) == before
    assert orjson.dumps(document) == before, "the document itself is left alone"


@pytest.mark.parametrize("rows", [1, 3 * BLOCK + 1])
def test_an_array_is_written_as_its_list(rows: int) -> None:
    table = np.random.default_rng(5).normal(size=(rows, 3)) * 10.0 ** np.arange(-200, 250, 150)
    found = b"".join(members([("a", table), ("b", [])]))
    assert found == orjson.dumps({"a": table.tolist(), "b": []})
    assert found == orjson.dumps({"a": table, "b": []}, option=orjson.OPT_SERIALIZE_NUMPY)


@pytest.mark.parametrize("given", [{}, {"method": "paper"}, {"proofs": True}])
@pytest.mark.parametrize("number", [1, 7])
def test_the_parts_of_an_answer_are_its_document(given: dict[str, Any], number: int) -> None:
    spec = process("go-no-go")
    states = [{"x_m": 0.5 * k, "y_m": 40} for k in range(number)]
    asked = spec.parse({"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "states": states} | given)
    document = spec.runner()(asked, Context()).document
    parts = dict(spec.output_parts(asked, Context()))
    assert orjson.dumps(parts, option=orjson.OPT_SERIALIZE_NUMPY) == orjson.dumps(document)
    spec.check(document)


def test_a_large_list_is_never_one_piece() -> None:
    assert max(map(len, pieces({"a": [1.5] * (20 * BLOCK)}))) < 5 * BLOCK


SHORT, LONG = [b"ab", b"c"], [b"x" * 400_000, b"y" * 700_000, b"z" * 3_000_000]


MARK = b"0123456789abcdef"


@pytest.fixture
def marked(tmp_path: Path) -> Where:
    path = tmp_path / "place"
    path.write_bytes(MARK)
    return Where(path, MARK)


def test_short_ones_need_no_file(marked: Where) -> None:
    assert put(marked, SHORT) == (b"abc", False)
    assert marked.path.read_bytes() == MARK
    assert sum(map(len, LONG)) > LONG_BYTES
    assert put(marked, LONG) == (b"", True)
    assert marked.path.read_bytes() == b"".join(LONG)


@pytest.mark.parametrize("where", [None, "gone"])
def test_without_a_file_they_come_whole(where: str | None, tmp_path: Path) -> None:
    place = where and Where(tmp_path / where, MARK)
    assert put(place, iter(LONG)) == (b"".join(LONG), False)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("most", [0, 1000, 400_000, 1_000_000, 1_100_000, 4_000_000])
def test_a_file_that_becomes_full_loses_nothing(most: int, marked: Where) -> None:
    child = os.fork()
    if child == 0:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
        os._exit(0 if put(marked, iter(LONG)) == (b"".join(LONG), False) else 1)
    assert os.waitpid(child, 0)[1] == 0


def in_another_process(where: Where) -> tuple[bool, bool]:
    """Whether the answer came whole, and whether it is in the file."""
    child = os.fork()
    if child == 0:
        os.closerange(3, 1000)  # a helper has none of the service's files
        body, in_file = put(where, iter(LONG))
        os._exit(2 * (body == b"".join(LONG)) + in_file)
    found = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return bool(found & 2), bool(found & 1)


@pytest.mark.parametrize("nameless", [True, False])
def test_nothing_is_left_where_a_service_is_killed(
    nameless: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On Linux a file has no name at any time: a service that was killed left one behind for every answer."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    if nameless and sys.platform != "linux":
        pytest.skip("the open files of a process are nowhere to be found")
    if not nameless:
        monkeypatch.setattr(Path, "is_dir", lambda _: False)
    found = Place()
    assert len(list(tmp_path.iterdir())) == (not nameless)
    assert in_another_process(found.where) == (False, True)
    taken = found.taken()
    found.close()
    assert not list(tmp_path.iterdir())
    with taken:
        assert taken.read() == b"".join(LONG)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a file has a name of its own")
def test_who_comes_late_lets_the_file_of_another_answer_alone(tmp_path: Path) -> None:
    late = Place()
    late.close()
    other = Place()
    assert other.where.path == late.where.path, "the number is given again"
    assert in_another_process(late.where) == (True, False)
    assert in_another_process(other.where) == (False, True)
    other.close()
    (tmp_path / "any").write_bytes(b"what somebody else has opened")
    with (tmp_path / "any").open("r+b") as file:
        assert str(file.fileno()) == late.where.path.name
        assert in_another_process(late.where) == (True, False)
    assert (tmp_path / "any").read_bytes() == b"what somebody else has opened"


def test_half_an_answer_is_an_error() -> None:
    """One whose making fails when its file has a part of it was cut to what was held in memory."""

    def parts() -> Iterator[bytes]:
        yield b"x" * (LONG_BYTES + 1)
        raise TimeoutError("in the middle")

    place = Place()
    try:
        with pytest.raises(TimeoutError, match="in the middle"):
            put(place.where, parts())
    finally:
        place.close()
