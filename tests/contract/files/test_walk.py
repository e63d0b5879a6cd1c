"""The walk of docs/files.md, command by command as it is written there."""

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from safestart.interchange.read import ephemeris_of

pytestmark = pytest.mark.slow
SPIN = "safestart timeline --chaser f.chaser.oem --target f.target.oem --spin 1 --a-max 0.1"
PAGE = Path(__file__).parents[3] / "docs" / "files.md"


def _blocks(language: str) -> list[str]:
    found = re.findall(r"^```(\w*)\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    return [text for name, text in found if name == language]


def _run(line: str, folder: Path) -> str:
    words = shlex.split(line)
    assert words[0] == "safestart"
    done = subprocess.run(
        [sys.executable, "-m", *words], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def walked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    folder = tmp_path_factory.mktemp("walk")
    said = []
    lines = [line for block in _blocks("sh")[:2] for line in block.splitlines()]  # the walk's own
    assert len(lines) == 5
    for line in lines:
        if line.startswith("echo "):
            words = shlex.split(line)
            assert words[2] == ">"
            (folder / words[3]).write_text(words[1], encoding="utf-8")
        else:
            said.append(_run(line, folder))
    return folder, said


def test_three_commands_lead_to_a_proved_go(walked: tuple[Path, list[str]]) -> None:
    folder, (_, timeline, verified, _) = walked
    shown = _blocks("")[0].splitlines()
    for line in shown:
        assert line.removesuffix("...") in timeline
    assert verified.startswith("GO proved")
    document = json.loads((folder / "timeline.json").read_text())
    assert [one["verdict"] for one in document["outputs"]["intervals"]] == ["GO", "UNDECIDED"]
    for name in ("timeline.timeline.png", "timeline.intervals.csv", "timeline.proofs.json"):
        assert (folder / name).stat().st_size > 100
    assert sorted(path.name for path in (folder / "proofs").iterdir()) == [
        "001-GO-begin.json",
        "001-GO-end.json",
    ]


def test_a_table_has_every_bit(walked: tuple[Path, list[str]]) -> None:
    folder, _ = walked
    one, other = ephemeris_of(folder / "f.chaser.oem"), ephemeris_of(folder / "chaser.csv")
    assert (one.states == other.states).all()
    assert (one.epochs == other.epochs).all()
    for name in ("again.xml", "again.mat", "again.parquet", "again.oem"):
        _run(f"safestart convert chaser.csv {name}", folder)
        assert (ephemeris_of(folder / name).states == one.states).all()
    _run("safestart convert f.target.aem target.csv", folder)
    _run("safestart convert target.csv target.aem", folder)
    rows = [
        [line for line in (folder / name).read_text().splitlines() if line[:1] == "2"]
        for name in ("f.target.aem", "target.aem")
    ]
    assert rows[0] == rows[1]


def test_the_notebook_says_the_same(
    walked: tuple[Path, list[str]], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, _ = walked
    monkeypatch.chdir(folder)
    (cell,) = _blocks("python")
    exec(compile(cell, "files.md", "exec"), {})
    found = json.loads((folder / "timeline.json").read_text())["outputs"]["intervals"]
    lines = [f"{one['begin']} {one['end']} {one['verdict']} {one['margin_m']}" for one in found]
    assert len(cell.splitlines()) <= 15
    assert capsys.readouterr().out.splitlines() == [*lines, found[0]["verdict"]]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("safestart convert none.oem a.csv", "a readable file"),
        ("safestart convert f.chaser.oem a.doc", "a name that ends in one of"),
        ("safestart convert f.json a.csv", "KEYWORD = value"),
        (SPIN.replace("f.chaser.oem", "f.target.aem"), "chaser: file: required states"),
        (SPIN.replace("--spin 1", ""), "an attitude or a spin"),
        (f"{SPIN} --corridor {{", "--corridor: required JSON"),
    ],
)  # fmt: skip
def test_a_refusal_is_a_sentence_and_leaves_nothing(
    walked: tuple[Path, list[str]], line: str, message: str
) -> None:
    folder, _ = walked
    before = sorted(folder.iterdir())
    done = subprocess.run(
        [sys.executable, "-m", *shlex.split(line)], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert sorted(folder.iterdir()) == before
