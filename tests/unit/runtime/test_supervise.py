"""The supervisor: restarts, orderly stop, no orphans. Each test runs it in a process of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from safestart.runtime.children.supervise import describe
from tests.waiting import PATIENCE_S, ended, until

# Writes its pid and that of a child of its own, then waits; ends in order on SIGTERM unless told to be stubborn.
COMMAND = """
import os, pathlib, signal, subprocess, sys, time
if "stubborn" in sys.argv:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
pathlib.Path(sys.argv[1]).write_text(f"{os.getpid()} {child.pid}")
time.sleep(600)
"""
SUPERVISOR = """
import sys
from safestart.runtime.children.supervise import Child, Supervisor
children = [Child(name, [sys.executable, "-c", *rest]) for name, *rest in eval(sys.argv[1])]
sys.exit(Supervisor(children, grace_s=1.0).run())
"""


def pids(file: Path) -> list[int]:
    until(lambda: file.exists() and len(file.read_text().split()) == 2, f"two pids in {file}")
    return [int(word) for word in file.read_text().split()]


def assert_ended(found: list[int]) -> None:
    until(lambda: all(map(ended, found)), f"the end of {found}")


@pytest.fixture
def supervise() -> Iterator[Callable[..., subprocess.Popen[str]]]:
    started: list[subprocess.Popen[str]] = []

    def start(*children: tuple[str, ...]) -> subprocess.Popen[str]:
        arguments = [sys.executable, "-c", SUPERVISOR, repr(list(children))]
        started.append(subprocess.Popen(arguments, stderr=subprocess.PIPE, text=True))
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.communicate()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_stops_every_child_and_grandchild(supervise, tmp_path: Path, number: int) -> None:
    supervisor = supervise(("a", COMMAND, str(tmp_path / "a")), ("b", COMMAND, str(tmp_path / "b")))
    found = pids(tmp_path / "a") + pids(tmp_path / "b")
    supervisor.send_signal(number)
    assert supervisor.wait(PATIENCE_S) == 0
    assert_ended(found)


def test_a_child_that_ignores_sigterm_is_killed_after_the_grace_period(supervise, tmp_path: Path) -> None:
    supervisor = supervise(("a", COMMAND, str(tmp_path / "a"), "stubborn"))
    found = pids(tmp_path / "a")
    supervisor.terminate()
    _, said = supervisor.communicate(timeout=PATIENCE_S)
    assert supervisor.returncode == 0
    assert "a did not stop within 1 s and was killed" in said
    assert_ended(found)


def test_a_child_that_dies_is_started_again_and_a_line_says_so(supervise, tmp_path: Path) -> None:
    file = tmp_path / "a"
    supervisor = supervise(("a", COMMAND, str(file)))
    first = pids(file)
    file.unlink()
    os.kill(first[0], signal.SIGKILL)
    second = pids(file)
    assert second[0] != first[0]
    assert_ended(first)  # what the dead command left behind is gone too
    supervisor.terminate()
    _, said = supervisor.communicate(timeout=PATIENCE_S)
    assert "safestart: a ended (signal 9, SIGKILL); starts again in 0.5 s" in said


def test_the_pause_between_restarts_doubles(supervise) -> None:
    supervisor = supervise(("a", "import sys; sys.exit(3)"))
    assert supervisor.stderr is not None
    lines = [supervisor.stderr.readline().strip() for _ in range(3)]
    assert lines == [
        f"safestart: a ended (exit code 3); starts again in {pause:g} s" for pause in (0.5, 1.0, 2.0)
    ]


def test_a_child_that_refuses_its_settings_ends_the_rest(supervise, tmp_path: Path) -> None:
    refuses = f"import os, sys, time\nwhile not os.path.exists({str(tmp_path / 'a')!r}): time.sleep(0.02)\nsys.exit(2)"
    supervisor = supervise(("a", COMMAND, str(tmp_path / "a")), ("b", refuses))
    found = pids(tmp_path / "a")
    _, said = supervisor.communicate(timeout=PATIENCE_S)
    assert supervisor.returncode == 2
    assert "b cannot run (exit code 2)" in said
    assert_ended(found)


def test_a_killed_supervisor_takes_its_children_with_it(supervise, tmp_path: Path) -> None:
    supervisor = supervise(
        ("a", COMMAND, str(tmp_path / "a")), ("b", COMMAND, str(tmp_path / "b"), "stubborn")
    )
    found = pids(tmp_path / "a") + pids(tmp_path / "b")
    supervisor.kill()
    assert_ended(found)


def test_a_command_that_does_not_exist_is_named(supervise) -> None:
    supervisor = subprocess.Popen(
        [
            sys.executable,
            "-c",
            "import sys\nfrom safestart.runtime.children.supervise import Child, Supervisor\n"
            "sys.exit(Supervisor([Child('a', ['/nonexistent/command'])]).run())",
        ],
        stderr=subprocess.PIPE,
        text=True,
    )
    assert supervisor.stderr is not None
    assert "cannot start /nonexistent/command" in supervisor.stderr.readline()
    assert "a ended (exit code 127)" in supervisor.stderr.readline()
    supervisor.terminate()
    supervisor.communicate(timeout=PATIENCE_S)


def test_exit_codes_in_words() -> None:
    assert describe(3) == "exit code 3"
    assert describe(-9) == "signal 9, SIGKILL"
