"""A missing directory is one sentence and code 2 in every command that writes: none makes it without being asked."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from safestart.cli import main
from safestart.cli.files import folder
from safestart.errors import InvalidInput
from safestart.flight_table import export as table

ASKED = ["--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--x-m", "5", "--y-m", "40", "--method", "exact"]


def refused(arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> str:
    monkeypatch.setattr(sys, "argv", ["safestart", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr()
    assert (ended.value.code, said.out) == (2, "")
    (line,) = [line for line in said.err.splitlines() if not line.startswith("database ")]
    return line


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (["go-no-go", *ASKED, "--proof", "{}/p.json"], "--proof"),
        (["run", "certificate", "--input", "{input}", "--output", "{}/d.json"], "--output"),
        (["export", "0", "--output", "{}/b.zip"], "--output"),
        (["export-c", "--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--output", "{}/c"], "--output"),
        (["backup", "{}/b.sqlite3", "--database-url", "sqlite:///{tmp}/d.sqlite3"], "directory"),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else None,
)
def test_a_missing_folder(
    arguments: list[str],
    option: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    given = tmp_path / "inputs.json"
    given.write_text(json.dumps({"omega_t_deg_s": 3, "a_max_m_s2": 0.1}))
    missing = tmp_path / "not" / "there"
    words = [
        word.replace("{input}", str(given)).replace("{tmp}", str(tmp_path)).replace("{}", str(missing))
        for word in arguments
    ]
    monkeypatch.setattr(table, "points_of", lambda *_: pytest.fail("refused after the work"))
    if arguments[0] == "backup":
        from safestart.store.database import Database

        database = Database(f"sqlite:///{tmp_path}/d.sqlite3")
        database.migrate()
        database.close()
    assert option in refused(words, monkeypatch, capsys)
    assert not (tmp_path / "not").exists()


def test_a_folder_is_made_but_not_its_parent(tmp_path: Path) -> None:
    made = tmp_path / "new"
    with folder("--proofs", made):
        assert made.is_dir()
    with folder("--proofs", made), folder("--proofs", None):
        pass
    with (
        pytest.raises(InvalidInput, match="--proofs: required a directory"),
        folder("--proofs", made / "a/b"),
    ):
        pass
    (tmp_path / "file").write_text("")
    with (
        pytest.raises(InvalidInput, match="--proofs: required a directory"),
        folder("--proofs", tmp_path / "file"),
    ):
        pass


def test_a_new_folder_goes_when_the_work_fails(tmp_path: Path) -> None:
    for name, stays in (("new", False), ("old", True)):
        path = tmp_path / name
        if stays:
            path.mkdir()
        with pytest.raises(ZeroDivisionError), folder("--proofs", path):
            raise ZeroDivisionError
        assert path.exists() == stays


def test_the_manifests_of_hostile_tables(tmp_path: Path) -> None:
    (tmp_path / "manifest.json").write_text("[" * 100_000)
    with pytest.raises(InvalidInput, match=r"manifest\.json: required the manifest"):
        table.verify(tmp_path)
