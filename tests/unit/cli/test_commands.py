"""The command line loads what the asked command needs: its start is counted in modules, not in seconds."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

import pytest
from typer.main import get_command

from safestart.cli import COMMAND_GROUP, COMMANDS, build
from safestart.errors import Misregistered
from safestart.runtime.own_process import exit_code

OURS = [name for names in COMMANDS.values() for name in names]
# Modules loaded after a command, counted on the day the budget was made and rounded up. NumPy and pydantic are two
# thirds of them.
VERDICT = ["go-no-go", "--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--x-m", "5", "--y-m", "40", "--json"]
BUDGETS = [(VERDICT, 520), (["keys", "--help"], 350), (["--help"], 620)]
NOT_FOR_A_VERDICT = {
    "asyncio",
    "ssl",
    "scipy",
    "numba",
    "matplotlib",
    "sqlalchemy",
    "pydantic_settings",
    "distributed",
}


def _commands(asked: str = "") -> dict[str, str]:
    group = get_command(build(asked))
    return {name: one.get_short_help_str(200) for name, one in group.commands.items()}  # type: ignore[attr-defined]


def test_the_help_lists_every_command_of_ours_and_of_the_other_packages() -> None:
    others = {point.name for point in entry_points(group=COMMAND_GROUP)}
    assert {"serve", "worker"} <= others
    assert set(_commands()) == {*OURS, "serve", "worker"}


@pytest.mark.parametrize("name", [*OURS, "serve", "worker"])
def test_a_command_alone_is_what_it_is_among_all(name: str) -> None:
    alone = _commands(name)
    assert alone.items() <= _commands().items()
    assert name in alone
    assert name in OURS or len(alone) == 1


@pytest.mark.parametrize("asked", ["nonsense", "--help", ""])
def test_everything_else_has_all_commands(asked: str) -> None:
    assert set(_commands(asked)) == set(_commands())


@pytest.mark.parametrize("fault", ["broken_plugin:add", "os:getcwd", "no.such.module:add"])
def test_a_broken_command_of_another_distribution_is_named(
    fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "broken_plugin.py").write_text("raise RuntimeError('torn')")
    monkeypatch.syspath_prepend(str(tmp_path))
    broken = EntryPoint("theirs", fault, COMMAND_GROUP)
    others = [*entry_points(group=COMMAND_GROUP), broken]
    monkeypatch.setattr("importlib.metadata.entry_points", lambda **_: others)
    with pytest.raises(Misregistered, match=r"the command theirs of .* to load"):
        build("theirs")
    assert set(_commands()) == {*OURS, "serve", "worker"}, "the others are there"
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("safestart: required the command theirs of")


@pytest.mark.parametrize(("command", "most"), BUDGETS, ids=[" ".join(words[:2]) for words, _ in BUDGETS])
def test_modules_that_a_command_loads(command: list[str], most: int) -> None:
    code = (
        "import json, sys; from safestart.cli import build\n"
        f"sys.argv = ['safestart', *{command!r}]\n"
        "try: build(sys.argv[1])()\n"
        "except SystemExit: pass\n"
        "print(); print(json.dumps(sorted(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = json.loads(done.stdout.splitlines()[-1])
    assert len(loaded) <= most
    if command is VERDICT:
        assert NOT_FOR_A_VERDICT.isdisjoint(loaded)
        assert '"verdict": "GO"' in done.stdout


@pytest.mark.parametrize("command", [VERDICT, ["verify", "x.json"], ["keys", "list"], ["export-c", "--help"]])
def test_every_command_refuses_a_variable_that_names_no_setting(
    command: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SAFESTART_DATABSE_URL", "hunter2")
    monkeypatch.setattr(sys, "argv", ["safestart", *command])
    assert exit_code(lambda: build(command[0])()) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert "SAFESTART_DATABSE_URL: required the name of a setting, such as SAFESTART_DATABASE_URL" in said.err
    assert "hunter2" not in said.err


@pytest.mark.parametrize(
    ("name", "value"), [("SAFESTART_PORT", "99999"), ("SAFESTART_CONFIG", "/nonexistent/file.toml")]
)
def test_a_command_that_reads_no_setting_checks_no_value(
    name: str, value: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "argv", ["safestart", *VERDICT])
    assert exit_code(lambda: build(VERDICT[0])()) == 0
