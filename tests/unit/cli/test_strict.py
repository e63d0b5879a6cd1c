"""The command line takes the numbers that a query takes, and no others, in every command."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

from safestart.cli import build, main
from safestart.cli.strict import Strict
from safestart.errors import InvalidInput
from safestart.model.plain_numbers import require_plain
from safestart.processes.door import PARAMETERS

LAX = ["1_0", "+5", " 5", "5 ", "\t5", "5\u00a0", "\u0665", "\uff15"]
POINT = {"--omega-t-deg-s": "3", "--a-max-m-s2": "0.1", "--x-m": "5", "--y-m": "40"}


def commands(group: Any, path: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], Any]]:
    """Every command of the line, with the words that lead to it."""
    found: list[tuple[tuple[str, ...], Any]] = []
    for name, one in group.commands.items():
        found += commands(one, (*path, name)) if hasattr(one, "commands") else [((*path, name), one)]
    return found


EVERY = [
    (path, one, option.opts[-1])
    for path, one in commands(get_command(build()))
    for option in one.params
    if option.name in getattr(one, "numbers", ())
]


def refused(arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: Any, stdin: str = "") -> str:
    """The one line that the command line ends with, code 2, in this process."""
    monkeypatch.setattr(sys, "argv", ["safestart", *arguments])
    monkeypatch.setattr(sys, "stdin", io.StringIO(stdin))
    with pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr()
    assert (ended.value.code, said.out) == (2, "")
    assert len(said.err.splitlines()) == 1
    return str(said.err)


def test_there_are_numbers_in_many_commands() -> None:
    assert {path for path, _, _ in EVERY} >= {
        ("go-no-go",),
        ("timeline",),
        ("export-c",),
        ("up",),
        ("keys", "create"),
        ("serve",),
        ("worker",),
    }
    assert all(isinstance(one, Strict) for _, one in commands(get_command(build())))


@pytest.mark.parametrize(("path", "one", "option"), EVERY, ids=[f"{' '.join(p)} {o}" for p, _, o in EVERY])
def test_every_number_of_every_command(path: tuple[str, ...], one: Any, option: str) -> None:
    for text in LAX:
        with pytest.raises(InvalidInput, match="a number") as caught:
            one.make_context(" ".join(path), [f"{option}={text}"])
        assert caught.value.field == option


@pytest.mark.parametrize("text", LAX)
def test_a_verdict_is_refused(
    text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`--x-m 1_0` was GO for x = 10."""
    words = [word for pair in (POINT | {"--x-m": text}).items() for word in pair]
    assert "--x-m" in refused(["go-no-go", *words], monkeypatch, capsys)


@pytest.mark.parametrize("text", ["1,2_0", "1, 2", "+1", "1,\u0662"])
@pytest.mark.parametrize("option", ["--omega-t-deg-s", "--a-max-m-s2"])
def test_lists_of_numbers(
    text: str,
    option: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = {"--omega-t-deg-s": "1", "--a-max-m-s2": "0.1", option: text, "--output": str(tmp_path / "c")}
    told = refused(["export-c", *(word for pair in words.items() for word in pair)], monkeypatch, capsys)
    assert option in told
    assert not (tmp_path / "c").exists()


@pytest.mark.parametrize("text", ["[5, 4_0, 0]", "[+5, 40, 0]", "[05, 40, 0]"])
def test_lists_as_json(
    text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--position-m", text]
    assert "position_m: required JSON" in refused(["go-no-go", *words], monkeypatch, capsys)


def test_a_text_in_a_file_is_no_number(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "x_m": "10", "y_m": 40}
    assert "x_m: required a number, received '10'" in refused(
        ["go-no-go", "--input", "-"], monkeypatch, capsys, json.dumps(given)
    )


def test_no_option_of_go_no_go_takes_a_number_as_a_text() -> None:
    """A number that Typer took as text would come to the model unchecked."""
    (go_no_go,) = [one for path, one in commands(get_command(build())) if path == ("go-no-go",)]
    for name, parameter in PARAMETERS.items():
        if parameter.field.annotation in (int, float, int | None, float | None):
            assert name in go_no_go.numbers


@pytest.mark.parametrize("text", ["0", "-0", "5", "-5.25", ".5", "5.", "1e3", "1E-3", "nan"])
def test_what_a_query_takes_is_taken(text: str) -> None:
    require_plain("x", text)
