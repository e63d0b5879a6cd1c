"""What a benchmark starts ends with it, helpers included, on an error and on SIGTERM, too."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.own_group import own_group
from tests.waiting import ended, until

ROOT = Path(__file__).parents[3]
# Like a service with a helper process: the helper ignores SIGTERM, and says its id.
FAMILY = ["sh", "-c", '(trap "" TERM; exec sleep 40) & echo $!; exec sleep 40']
RUN = f"""
import time
from benchmarks.own_group import own_group
with own_group({FAMILY!r}):
    time.sleep(40)
"""


def test_an_exception_ends_the_helpers_too() -> None:
    helpers: list[int] = []

    def fails() -> None:
        with own_group(FAMILY, stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            helpers.append(int(process.stdout.readline()))
            assert not ended(helpers[0])
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fails()
    until(lambda: ended(helpers[0]), "the end of the helper", 20.0)


def test_sigterm_ends_the_helpers_too() -> None:
    with subprocess.Popen([sys.executable, "-c", RUN], cwd=ROOT, stdout=subprocess.PIPE) as benchmark:
        assert benchmark.stdout is not None
        helper = int(benchmark.stdout.readline())
        benchmark.terminate()
        assert benchmark.wait(60) == 128 + 15
    until(lambda: ended(helper), "the end of the helper", 20.0)
