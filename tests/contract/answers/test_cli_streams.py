"""Standard streams that are full or closed, and files that cannot be written: one sentence, the right exit code."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from safestart.cli import main
from safestart.records.labels import Labels
from safestart.store.access.audit import AuditLog
from safestart.store.access.keys import KeyRepository
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository

ASKED = ["go-no-go", "--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--x-m", "5", "--y-m", "40"]
NONE = "/dev/full"
pytestmark = pytest.mark.skipif(not Path(NONE).exists(), reason="needs /dev/full")


def ended(arguments: list[str], redirected: str) -> tuple[int, str]:
    """Exit code and standard error of a command behind a shell's redirection."""
    line = f'exec "$@" {redirected}'
    command = ["sh", "-c", line, "sh", sys.executable, "-m", "safestart", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.returncode, done.stderr


@pytest.fixture(scope="module")
def proof(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("proof") / "proof.json"
    subprocess.run(
        [sys.executable, "-m", "safestart", *ASKED, "--method", "exact", "--proof", str(path)],
        check=True,
        capture_output=True,
    )
    return path


@pytest.mark.parametrize(
    "arguments",
    [
        ASKED,
        [*ASKED, "--json"],
        ["--help"],
        ["run", "certificate", "--input", "INPUT", "--json"],
        ["keys", "list", "--database-url", "sqlite:///DATABASE"],
        ["verify", "PROOF"],
    ],
    ids=lambda arguments: " ".join(arguments[:1] + arguments[-1:]),
)
def test_a_full_disk_behind_standard_output(arguments: list[str], proof: Path, tmp_path: Path) -> None:
    asked = tmp_path / "in.json"
    asked.write_text('{"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 3, "ny": 3}}')
    places = {"INPUT": str(asked), "PROOF": str(proof), "DATABASE": str(tmp_path / "keys.sqlite3")}
    for name, place in places.items():
        arguments = [argument.replace(name, place) for argument in arguments]
    code, said = ended(arguments, f">{NONE}")
    lines = [line for line in said.splitlines() if line.startswith("safestart:")]
    assert (code, len(lines)) == (2, 1), said
    assert "No space left on device" in lines[0]
    assert "Traceback" not in said
    assert "Exception" not in said


def test_a_closed_standard_output() -> None:
    code, said = ended(ASKED, ">&-")
    assert (code, len(said.splitlines())) == (2, 1)
    assert ended(ASKED, ">&- 2>&- <&-") == (2, "")


@pytest.mark.parametrize(("rejected", "expected"), [(False, 0), (True, 1)])
def test_a_reader_that_left(rejected: bool, expected: int, proof: Path, tmp_path: Path) -> None:
    """Silence, and the verdict of the command all the same."""
    document = json.loads(proof.read_text())
    if rejected:
        document["verdict"] = "NO_GO" if document["verdict"] == "GO" else "GO"
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(document))
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "safestart", "verify", str(path)]
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert (done.returncode, done.stderr) == (expected, "")


def test_standard_error_that_is_full_does_not_matter() -> None:
    assert ended(ASKED, f"2>{NONE}") == (0, "")


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        ([*ASKED, "--proof"], "--proof"),
        (["run", "certificate", "--input", "INPUT", "--output"], "--output"),
        (["export", "no-such-job", "--output"], "--output"),
    ],
)
def test_a_place_that_cannot_be_written_is_named_before_the_work(
    arguments: list[str],
    option: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    asked = tmp_path / "in.json"
    asked.write_text('{"omega_t_deg_s": 3, "a_max_m_s2": 0.1}')

    def work(*_: object, **__: object) -> None:
        raise AssertionError("the work has begun")

    monkeypatch.setattr("safestart.processes.go_no_go.one_start.OneAtRest.document", work)
    for name in ("run.execute", "records._bundle_of"):
        monkeypatch.setattr(f"safestart.cli.{name}", work)
    # A directory: even root cannot write it.
    monkeypatch.setattr(
        sys, "argv", ["s", *(a.replace("INPUT", str(asked)) for a in arguments), str(tmp_path)]
    )
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert f"{option}: required a writable path" in said
    assert len(said.splitlines()) == 1


def test_what_was_there_stays_when_the_work_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    there, new = tmp_path / "there.json", tmp_path / "new.json"
    there.write_text("kept")
    for path in (there, new):
        monkeypatch.setattr(
            sys, "argv", ["s", *ASKED, "--method", "paper", "--proof", str(path)]
        )  # the paper's conditions prove nothing
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == 2
        assert "--proof" in capsys.readouterr().err
    assert there.read_text() == "kept"
    assert not new.exists()


def test_a_shorter_document_replaces_a_longer_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "proof.json"
    path.write_text("x" * 100_000)
    monkeypatch.setattr(sys, "argv", ["s", *ASKED, "--method", "exact", "--proof", str(path)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 0
    assert json.loads(path.read_text())["verdict"] == "GO"


@pytest.mark.parametrize("form", [[], ["--json"]], ids=["text", "json"])
@pytest.mark.parametrize(
    ("redirected", "reason"),
    [(f">{NONE}", "No space left on device"), (">&-", "it is closed"), ("| :", "nobody reads it")],
)
def test_a_key_that_cannot_be_shown_is_not_made(
    form: list[str], redirected: str, reason: str, tmp_path: Path
) -> None:
    """The first key closes the service for good: one that nobody has seen would close it to everybody."""
    url = f"sqlite:///{tmp_path / 'keys.sqlite3'}"
    asked = ["keys", "create", "--name", "a", "--role", "admin", "--database-url", url, *form]
    if redirected.startswith("|"):
        reader, writer = os.pipe()
        os.close(reader)
        command = [sys.executable, "-m", "safestart", *asked]
        done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
        os.close(writer)
        code, said = done.returncode, done.stderr
    else:
        code, said = ended(asked, redirected)
    assert (code, len(said.splitlines())) == (2, 1), said
    assert f"({reason}); no key was made" in said
    database = Database(url)
    database.migrate()
    assert KeyRepository(database).list() == ()
    assert AuditLog(database).entries().entries == ()
    database.close()


@pytest.mark.parametrize(
    "arguments",
    [
        ["verify", "-"],
        ["verify", "-", "--json"],
        ["go-no-go", "--input", "-"],
        ["run", "certificate", "--input", "-"],
    ],
    ids=lambda arguments: " ".join(arguments),
)
@pytest.mark.parametrize("more", ["", ">&-"])
def test_a_closed_standard_input(arguments: list[str], more: str) -> None:
    """Code 2: the code 1 of `verify` would say that the proof is wrong."""
    code, said = ended(arguments, f"<&- {more}")
    assert (code, len(said.splitlines())) == (2, 1), said
    assert "it is closed" in said
    assert ended(arguments, f"<&- {more} 2>&-") == (2, "")


ENCODINGS: list[dict[str, str]] = [
    {"PYTHONIOENCODING": "ascii"},
    {"PYTHONIOENCODING": "latin-1"},
    {"PYTHONIOENCODING": "cp437"},
    {"PYTHONIOENCODING": "ascii:strict"},
    {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
]


@pytest.mark.parametrize("terminal", ENCODINGS, ids=str)
def test_an_encoding_that_lacks_what_is_said(terminal: dict[str, str], tmp_path: Path) -> None:
    """On standard output and in errors of every command, as the streams are those of the whole process."""
    url = f"sqlite:///{tmp_path}/jobs.sqlite3"
    database = Database(url)
    database.migrate()
    job = JobRepository(database).submit(
        "certificate", {}, timeout_s=9, labels=Labels(name="日本", note="é ²")
    )
    database.close()
    for arguments, code, stream in (
        (["label", job.id, "--database-url", url], 0, "stdout"),
        (["reproduce", "table1"], 0, "stdout"),
        (["run", "日本 ²"], 2, "stderr"),
        (["go-no-go", "--日本"], 2, "stderr"),
        (["--help"], 0, "stdout"),
    ):
        command = [sys.executable, "-m", "safestart", *arguments]
        plain = {name: value for name, value in os.environ.items() if name != "PYTHONUTF8"}
        done = subprocess.run(command, capture_output=True, env=plain | terminal, check=False)
        assert done.returncode == code, done.stderr
        assert b"Traceback" not in done.stderr
        assert getattr(done, stream)
        if arguments[0] == "label":
            assert rb"\u65e5\u672c" in done.stdout


CHILD = """
import subprocess, sys
from safestart.cli.streams import patient_streams
with patient_streams():
    print("日本" * 100_000, file=sys.stderr)
    subprocess.run(["sh", "-c", "echo said; echo said >&2"], stdout=sys.stderr, stderr=sys.stdout, check=True)
"""


@pytest.mark.parametrize("redirected", ["2>&-", ">&-", "<&- >&- 2>&-"])
def test_a_child_of_a_command_whose_outputs_are_closed(redirected: str) -> None:
    """`up` and `demo` give theirs the standard error."""
    command = ["sh", "-c", f'exec "$@" {redirected}', "sh", sys.executable, "-c", CHILD]
    done = subprocess.run(command, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
