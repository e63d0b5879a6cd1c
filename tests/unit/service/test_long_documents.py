"""Long answers: their text is made piece by piece, and lies in a file as long as there is room for it."""

from __future__ import annotations

import os
import resource
import signal
from pathlib import Path
from typing import Any

import numpy as np
import orjson
import pytest

from safestart.processes.registry import process
from safestart.runtime.progress import Context
from safestart_service.computing.long_answers import LONG_BYTES, put
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


def test_short_ones_need_no_file(tmp_path: Path) -> None:
    place = tmp_path / "place"
    place.touch()
    assert put(place, SHORT) == (b"abc", False)
    assert place.read_bytes() == b""
    assert sum(map(len, LONG)) > LONG_BYTES
    assert put(place, LONG) == (b"", True)
    assert place.read_bytes() == b"".join(LONG)


@pytest.mark.parametrize("where", [None, "gone"])
def test_without_a_file_they_come_whole(where: str | None, tmp_path: Path) -> None:
    assert put(where and tmp_path / where, iter(LONG)) == (b"".join(LONG), False)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("most", [0, 1000, 400_000, 1_000_000, 1_100_000, 4_000_000])
def test_a_file_that_becomes_full_loses_nothing(most: int, tmp_path: Path) -> None:
    place = tmp_path / "place"
    place.touch()
    child = os.fork()
    if child == 0:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
        os._exit(0 if put(place, iter(LONG)) == (b"".join(LONG), False) else 1)
    assert os.waitpid(child, 0)[1] == 0
