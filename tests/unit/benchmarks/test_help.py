"""Every benchmark that can be run by hand says what it does when it is asked, and does not begin to measure."""

from __future__ import annotations

import ast
import runpy
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


def name_of(file: Path) -> str:
    return ".".join(file.relative_to(ROOT).with_suffix("").parts)


RUNNABLE = {
    name_of(file): text
    for file in sorted((ROOT / "benchmarks").rglob("*.py"))
    if '__name__ == "__main__"' in (text := file.read_text())
}


def test_the_benchmarks_are_found() -> None:
    assert {"benchmarks.go_no_go", "benchmarks.curves.__main__"} < RUNNABLE.keys()


@pytest.mark.timeout(120)
@pytest.mark.filterwarnings("ignore:.*found in sys.modules:RuntimeWarning")  # another one imported it
@pytest.mark.parametrize("name", RUNNABLE)
def test_help_shows_the_docstring(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # First without running it: one that ignores its arguments would measure for hours.
    assert "__doc__" in RUNNABLE[name], "required: a parser that is given the docstring"
    monkeypatch.setattr(sys, "argv", [name, "--help"])
    with pytest.raises(SystemExit) as ended:
        runpy.run_module(name, run_name="__main__")
    assert ended.value.code == 0
    said, text = capsys.readouterr().out, ast.get_docstring(ast.parse(RUNNABLE[name]))
    assert text is not None
    assert said.startswith("usage: ")
    assert text.splitlines()[0] in said
