"""``safestart bench``: figures by name."""

from __future__ import annotations

import json
import sys
from types import ModuleType

import pytest
from typer.testing import CliRunner

import benchmarks
from safestart.cli import build
from safestart.cli.bench import add


def test_two_benchmarks_may_not_use_one_name() -> None:
    times = {"verify_s": 0.001}
    with pytest.raises(ValueError, match=r"in_space: .* received \['verify_s'\]"):
        add(times, {"verify_s": 0.77, "other_s": 1.0}, "in_space")
    assert times == {"verify_s": 0.001}
    add(times, {"other_s": 1.0}, "in_space")
    assert times == {"verify_s": 0.001, "other_s": 1.0}


@pytest.fixture
def three_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A suite whose second benchmark fails, as on a busy machine: with an error that has no text."""

    def late() -> None:
        raise TimeoutError

    parts = {
        "first": lambda: {"ratios": {"a": 2.0}, "times": {}},
        "second": late,
        "third": lambda: {"ratios": {}, "times": {"b_s": 0.5}},
    }
    for name, measure in parts.items():
        module = ModuleType(f"benchmarks.{name}")
        module.measure = measure  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setattr(benchmarks, "BENCHMARKS", tuple(parts))
    monkeypatch.setitem(sys.modules, "benchmarks", benchmarks)


@pytest.mark.usefixtures("three_parts")
def test_a_part_that_fails_is_named_and_the_others_are_printed() -> None:
    result = CliRunner().invoke(build("bench"), ["bench", "--json"])
    document = json.loads(result.stdout)
    assert (document["ratios"], document["times"]) == ({"a": 2.0}, {"b_s": 0.5})
    assert document["missing"] == {"second": "TimeoutError"}
    assert result.exit_code == 1


@pytest.mark.usefixtures("three_parts")
def test_the_reason_stands_on_stderr_beside_the_tables(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="1"):
        build("bench")(["bench"])
    said = capfd.readouterr()
    assert "second is missing: TimeoutError" in said.err
    assert "b_s" in said.out
