"""Files at their names whole, or not at all: full disks, limits, pipes, links, folders that take nothing new."""

from __future__ import annotations

import errno
import os
import resource
import signal
import stat
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import FileIO
from pathlib import Path

import pytest

from safestart.runtime.files import whole
from safestart.runtime.files.whole import Whole

DATA = b"new" * 5000


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """The system takes a part of what is written, and says so only by its number, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)


def write_two(first: Path, one: bytes, second: Path, other: bytes) -> None:
    with Whole() as files:
        files.add(first, one)
        files.add(second, other)


def test_all_of_it_is_there(tmp_path: Path) -> None:
    with Whole() as files:
        files.add(tmp_path / "one", DATA)
        files.add(tmp_path / "two", b"")
        assert not (tmp_path / "one").exists(), "not before all are written"
    assert (tmp_path / "one").read_bytes() == DATA
    assert sorted(one.name for one in tmp_path.iterdir()) == ["one", "two"]
    umask = os.umask(0)
    os.umask(umask)
    assert stat.S_IMODE((tmp_path / "one").stat().st_mode) == 0o666 & ~umask


@pytest.mark.parametrize("size", [0, 1, 4096, len(DATA) - 1])
def test_a_full_disk_changes_nothing(tmp_path: Path, size: int) -> None:
    (tmp_path / "old").write_bytes(b"old")
    with files_of_at_most(size), pytest.raises(OSError, match="File too large"):
        write_two(tmp_path / "small", b"", tmp_path / "old", DATA)
    assert [one.name for one in tmp_path.iterdir()] == ["old"]
    assert (tmp_path / "old").read_bytes() == b"old"


def test_a_file_without_a_write_is_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "old").write_bytes(b"old")
    with Whole() as files:
        files.open(tmp_path / "old")
        files.open(tmp_path / "new")
    assert [one.name for one in tmp_path.iterdir()] == ["old"]
    assert (tmp_path / "old").read_bytes() == b"old"


def test_it_is_written_twice(tmp_path: Path) -> None:
    with Whole() as files:
        file = files.open(tmp_path / "one")
        file.write(DATA)
        file.write(b"short")
    assert (tmp_path / "one").read_bytes() == b"short"


def test_mode_and_link_stay(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    old, link = tmp_path / "there" / "old", tmp_path / "link"
    old.write_bytes(b"old")
    old.chmod(0o640)
    link.symlink_to(old)
    with Whole() as files:
        files.add(link, DATA)
    assert link.is_symlink()
    assert old.read_bytes() == DATA
    assert stat.S_IMODE(old.stat().st_mode) == 0o640


def test_a_link_to_nothing_makes_what_it_names(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("named")
    with Whole() as files:
        files.add(tmp_path / "link", DATA)
    assert (tmp_path / "named").read_bytes() == DATA
    assert (tmp_path / "link").is_symlink()


@pytest.mark.parametrize(
    ("name", "number"),
    [("", errno.EISDIR), ("no/x", errno.ENOENT), ("loop", errno.ELOOP), ("a" * 256, errno.ENAMETOOLONG)],
)
def test_a_place_that_is_none_is_said_before_the_work(tmp_path: Path, name: str, number: int) -> None:
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(OSError) as refused, Whole() as files:
        files.open(tmp_path / name)
    assert refused.value.errno == number
    assert [one.name for one in tmp_path.iterdir()] == ["loop"]


def test_a_pipe_gets_all(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    data = DATA * 100  # more than a pipe holds
    code = f"import sys; print(len(sys.stdin.buffer.read()) == {len(data)})"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=reader, stdout=subprocess.PIPE, text=True
    ) as child:
        os.close(reader)
        with Whole() as files:
            files.add(Path(f"/dev/fd/{writer}"), data)
        os.close(writer)
        assert child.communicate()[0] == "True\n"


def test_what_others_write_to_stays(tmp_path: Path) -> None:
    """``(one; safestart run ... --output /dev/stdout; another) > log``."""
    log = tmp_path / "log"
    code = (
        "from pathlib import Path; from safestart.runtime.files.whole import Whole\n"
        "print('one', flush=True)\n"
        "with Whole() as files: files.add(Path('/dev/stdout'), b'two\\n')\n"
        "print('three', flush=True)"
    )
    with log.open("a") as opened:
        subprocess.run([sys.executable, "-c", code], stdout=opened, check=True)
    assert log.read_text() == "one\ntwo\nthree\n"


@pytest.mark.skipif(sys.platform != "linux" or os.geteuid() != 0, reason="only root can be another user")
def test_a_folder_that_takes_no_new_files(tmp_path: Path) -> None:
    (tmp_path / "old").write_bytes(b"older")
    (tmp_path / "old").chmod(0o666)
    for folder in (tmp_path, *tmp_path.parents[:3]):
        folder.chmod(folder.stat().st_mode | 0o055)
    tmp_path.chmod(0o755)
    child = os.fork()
    if child == 0:
        os.setuid(65534)
        try:
            with Whole() as files:
                files.add(tmp_path / "old", b"new")
            with pytest.raises(PermissionError), Whole() as files:
                files.add(tmp_path / "new", b"new")
        except BaseException:
            os._exit(1)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
    assert (tmp_path / "old").read_bytes() == b"new"


def test_somebody_elses_file_where_each_may_replace_their_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "old").write_bytes(b"older")

    def refuse(*_: object) -> None:
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "replace", refuse)
    with Whole() as files:
        files.add(tmp_path / "old", b"new")
    assert (tmp_path / "old").read_bytes() == b"new"
    assert [one.name for one in tmp_path.iterdir()] == ["old"]


def test_a_system_that_takes_little_at_once_gets_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Slow(FileIO):
        def write(self, data: bytes, /) -> int:  # type: ignore[override]
            return super().write(memoryview(data)[:7])

    monkeypatch.setattr(whole, "FileIO", Slow)
    with Whole() as files:
        files.add(tmp_path / "one", DATA)
    assert (tmp_path / "one").read_bytes() == DATA
