"""Whatever never ends is refused after the bound, before memory is: devices, pipes, files of holes, standard input."""

from __future__ import annotations

import io
import os
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import pytest

from safestart.cli import build
from safestart.cli.files import MOST_INPUT_BYTES, given_bytes
from safestart.errors import InvalidInput
from safestart.flight_table import export
from safestart.interchange.source import bytes_of
from safestart.public.proofs import verify
from safestart.records.bundle import MOST_BYTES
from safestart.runtime.files import secret_file
from safestart.runtime.files.bounded import bytes_within, stream_within
from safestart.runtime.own_process import exit_code
from safestart.runtime.settings import Settings

ENDLESS = "/dev/zero"
pytestmark = pytest.mark.skipif(not Path(ENDLESS).exists(), reason="needs /dev/zero")


def sparse(folder: Path, name: str = "sparse") -> Path:
    """20 GB of holes."""
    with (folder / name).open("wb") as file:
        file.truncate(20 * 10**9)
    return folder / name


def test_the_bound_itself(tmp_path: Path) -> None:
    (tmp_path / "ten").write_bytes(b"0123456789")
    assert bytes_within("file", tmp_path / "ten", 10) == b"0123456789"
    for read in (
        lambda: bytes_within("file", tmp_path / "ten", 9),
        lambda: bytes_within("file", ENDLESS, 9),
        lambda: stream_within("file", io.BytesIO(b"0123456789"), 9, "ten"),
    ):
        with pytest.raises(InvalidInput, match="file: required at most 9 bytes, received"):
            read()
    with pytest.raises(OSError, match="No such file"):
        bytes_within("file", tmp_path / "none", 9)


@pytest.mark.parametrize(
    "command",
    [
        ["run", "go-no-go", "--input"],
        ["go-no-go", "--input"],
        ["import", "--database-url", "sqlite:///{tmp}/u.sqlite3"],
        ["replay", "--database-url", "sqlite:///{tmp}/u.sqlite3"],
        ["verify"],
        ["convert", "{tmp}/b.oem"],
    ],
    ids=lambda command: command[0],
)
@pytest.mark.parametrize("holes", [False, True], ids=["device", "holes"])
def test_every_command_that_reads_a_file(
    command: list[str], holes: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = str(sparse(tmp_path)) if holes else ENDLESS
    words = [word.replace("{tmp}", str(tmp_path)) for word in command]
    words = [words[0], file, *words[1:]] if words[-1] != "--input" else [*words, file]
    tracemalloc.start()
    try:
        assert exit_code(lambda: build(words[0])(words)) == 2
        assert tracemalloc.get_traced_memory()[1] < 2.5 * MOST_BYTES
    finally:
        tracemalloc.stop()
    last = capsys.readouterr().err.splitlines()[-1]
    # To replay, a device is no file, and so the id of a job.
    assert ("an existing database" if command[0] == "replay" and not holes else "at most") in last


@pytest.mark.parametrize(
    "read",
    [
        lambda path: bytes_of(path),
        lambda path: verify(path),
        lambda path: secret_file.with_password("postgresql://me@here/db", str(path)),
    ],
    ids=["a file of the field", "a proof", "a password"],
)
def test_every_function_that_reads_a_file(read: Callable[[Path], object], tmp_path: Path) -> None:
    for path in (Path(ENDLESS), sparse(tmp_path)):
        with pytest.raises(InvalidInput, match="at most"):
            read(path)


def test_a_written_table(tmp_path: Path) -> None:
    sparse(tmp_path, "manifest.json")
    with pytest.raises(InvalidInput, match=r"manifest\.json: required at most"):
        export.verify(tmp_path)


def test_a_settings_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SAFESTART_CONFIG", str(sparse(tmp_path, "safestart.toml")))
    with pytest.raises(InvalidInput, match="at most 1048576 bytes"):
        Settings()  # type: ignore[call-arg, unused-ignore]


def test_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    with Path(ENDLESS).open() as endless:
        monkeypatch.setattr(sys, "stdin", endless)
        with pytest.raises(InvalidInput, match="standard input with more"):
            given_bytes("--input", "-", MOST_INPUT_BYTES)
    for text in (io.StringIO("{}"), io.TextIOWrapper(io.BytesIO(b"{}"))):
        monkeypatch.setattr(sys, "stdin", text)
        assert given_bytes("--input", "-", MOST_INPUT_BYTES) == b"{}"
    reader, writer = os.pipe()
    os.write(writer, b"0123456789")
    os.close(writer)
    with os.fdopen(reader) as pipe:
        monkeypatch.setattr(sys, "stdin", pipe)
        with pytest.raises(InvalidInput, match="at most 9 bytes"):
            given_bytes("--input", "-", 9)
