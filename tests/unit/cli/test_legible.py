"""What a file or a server says is shown, and never acts on the terminal."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path

import pytest
from typer.testing import CliRunner

from safestart.cli import build, console
from safestart.errors import InvalidInput
from safestart.runtime.logs import legible
from safestart.runtime.own_process import exit_code

HOSTILE = "a\x1b[31m\u202eb\u200b\x9bc\ud800\u2028d\r"
SHOWN = "a\\x1b[31m\\u202eb\\u200b\\x9bc\\ud800\\u2028d\\r"


def test_control_format_and_surrogate_characters_are_escaped() -> None:
    assert legible(HOSTILE) == SHOWN
    assert legible("Δv 3 m/s – ok\u202f!") == "Δv 3 m/s – ok\u202f!"
    assert legible("a\nb", keep="\n") == "a\nb"


def test_an_error_shows_them_escaped(capsys: pytest.CaptureFixture[str]) -> None:
    def refuse() -> None:
        raise InvalidInput(f"{HOSTILE}\nsafestart: GO")

    assert exit_code(refuse) == 2
    assert capsys.readouterr().err == f"safestart: {SHOWN}\\nsafestart: GO\n"


@pytest.mark.parametrize("terminal", [True, False])
def test_a_console_shows_them_escaped_and_keeps_its_colours(terminal: bool) -> None:
    # A console of its own: the commands' consoles follow sys.stdout, and whoever sets their file ends that.
    found = io.StringIO()
    own = console.LegibleConsole(
        file=found,
        force_terminal=terminal,
        color_system="standard" if terminal else None,
        width=112,
        highlight=False,
    )
    shown = console.table_of("t", (("name", "left"),))
    shown.add_row(HOSTILE.replace("\r", "").replace("[31m", ""))
    own.print(shown)
    own.print(f"{HOSTILE}\nnext", markup=False, soft_wrap=True)
    own.print("red", style="bold red")
    said = found.getvalue()
    assert not any(c in said for c in "\u202e\u200b\x9b\ud800\u2028\r")
    assert "\x1b[31m" not in said
    assert "\\x1b[31m\\u202eb" in said
    assert "\nnext\n" in said
    assert ("\x1b[1;31mred" in said) == terminal


def test_the_commands_consoles_are_legible_and_follow_the_streams(capsys: pytest.CaptureFixture[str]) -> None:
    console.out.print("a\u202eb", markup=False)
    console.err.print("c\u202ed", markup=False)
    said = capsys.readouterr()
    assert (said.out, said.err) == ("a\\u202eb\n", "c\\u202ed\n")


def test_the_name_in_a_bundle_acts_on_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "x.zip"
    with zipfile.ZipFile(file, "w") as archive:
        manifest = {"format": "safestart-bundle", "version": 1, "files": {}, "media_types": {}}
        archive.writestr("manifest.json", json.dumps(manifest))
        archive.writestr("artifacts/a\x1b[31m\u202eb.npz", b"x")
    run = CliRunner().invoke(build("import"), ["import", str(file)])
    assert isinstance(run.exception, InvalidInput)
    assert exit_code(lambda: _raise(run.exception)) == 2
    said = capsys.readouterr().err
    assert "artifacts/a\\x1b[31m\\u202eb.npz is not in the manifest" in said
    assert "\x1b" not in said


def _raise(error: BaseException | None) -> None:
    assert error is not None
    raise error
