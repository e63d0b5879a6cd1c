"""Lines of a process that logs: each in the form that was asked for, with the job or the request that it is about."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from tests.waiting import PATIENCE_S

CODE = """
import logging, sys, warnings
library = logging.getLogger("library")  # with a handler of its own, as Dask has
library.addHandler(logging.StreamHandler())
library.propagate = False
from safestart.runtime.logs import about, configure
configure(sys.argv[1])
log = logging.getLogger("safestart.test")
log.info("begins\\nin two lines", extra=about(job="j1"))
try:
    raise ValueError("first\\nsecond")
except ValueError:
    log.exception("went %s", "wrong", extra=about(job="j1", request="r1"))
warnings.warn("careful")
library.error("theirs")
logging.getLogger("else").info("not shown")
"""


def lines(form: str) -> list[str]:
    ended = subprocess.run(
        [sys.executable, "-c", CODE, form], capture_output=True, text=True, timeout=PATIENCE_S, check=True
    )
    assert ended.stdout == ""
    return ended.stderr.splitlines()


def test_json_is_one_object_a_line_whatever_is_told_and_by_whom() -> None:
    first, second, third, fourth = map(json.loads, lines("json"))
    assert first["message"] == "begins\nin two lines"
    assert (first["level"], first["logger"], first["job"]) == ("info", "safestart.test", "j1")
    assert "request" not in first
    assert (second["job"], second["request"], second["message"]) == ("j1", "r1", "went wrong")
    assert second["trace"].endswith("ValueError: first\nsecond")
    assert (third["level"], third["logger"]) == ("warning", "py.warnings")
    assert "careful" in third["message"]
    assert (fourth["logger"], fourth["message"]) == ("library", "theirs")
    assert all(line["time"].endswith("+00:00") for line in (first, second, third, fourth))


@pytest.mark.parametrize("said", ["INFO safestart.test job=j1 begins", "job=j1 request=r1 went wrong"])
def test_text_names_the_job(said: str) -> None:
    assert any(said in line for line in lines("text"))
