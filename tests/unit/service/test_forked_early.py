"""The process that forks helpers is forked from the service itself, and shares its memory."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event

import httpx
import psutil
import pytest

from benchmarks.worst_requests_watch import memory_of
from safestart_service.computing.helpers.early import Child, forked
from tests.waiting import PATIENCE_S, ended, free_port, until

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere it is a program of its own")

MANY = {
    "omega_t_deg_s": 3,
    "a_max_m_s2": 0.1,
    "method": "paper",
    "states": [{"x_m": 1e-4 * k, "y_m": 40} for k in range(5000)],
}


class Served:
    """A service of ours, as ``safestart serve`` starts it."""

    def __init__(self, folder: Path) -> None:
        self.port = free_port()
        environment = os.environ | {"SAFESTART_DATABASE_URL": f"sqlite:///{folder}/store"}
        command = [sys.executable, "-m", "safestart", "serve", "--port", str(self.port)]
        self.process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        self.process.stdout.readline()
        self.address = f"http://127.0.0.1:{self.port}"

    def heavy(self) -> int:
        """Status of an answer by a helper."""
        return httpx.post(f"{self.address}/go-no-go", json=MANY, timeout=PATIENCE_S).status_code

    def family(self) -> list[psutil.Process]:
        """The process that forks, and the helpers."""
        return psutil.Process(self.process.pid).children(recursive=True)


@pytest.fixture
def served(tmp_path: Path):
    found = Served(tmp_path)
    yield found
    found.process.kill()
    found.process.wait()


def test_it_shares_what_the_service_has_loaded(served: Served) -> None:
    assert served.heavy() == 200
    service = psutil.Process(served.process.pid)
    (forks,) = service.children()
    assert "nursery" not in " ".join(forks.cmdline())
    own, all_of_it = memory_of([service])["Pss_Anon"], service.memory_full_info().uss
    assert own > 1.1 * all_of_it, "a part of its memory is that of others, too"


def test_it_is_replaced_by_a_program_of_its_own(served: Served) -> None:
    assert served.heavy() == 200
    for process in served.family():
        process.kill()
    assert until(lambda: served.heavy() == 200, "an answer by a new one")
    assert any("helpers.nursery" in " ".join(one.cmdline()) for one in served.family())


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize("stopped", [False, True])
def test_none_outlives_the_service(how: signal.Signals, stopped: bool, served: Served) -> None:
    family = served.family()
    assert family
    if stopped:
        family[0].suspend()
    served.process.send_signal(how)
    served.process.wait(PATIENCE_S)
    assert until(lambda: all(ended(one.pid) for one in family), "the end of all processes")


def test_it_holds_no_port(served: Served) -> None:
    """A port that it had inherited would take connections that nobody accepts."""
    assert served.heavy() == 200
    for process in served.family():
        assert not [one for one in process.net_connections() if one.status == psutil.CONN_LISTEN]


def test_a_keystroke_says_nothing(served: Served) -> None:
    """Ctrl-C reaches all processes of a terminal, also those that have not begun to load."""
    for process in served.family():
        process.send_signal(signal.SIGINT)
    assert served.heavy() == 200
    assert psutil.Process(served.process.pid).children(), "it lives"


def test_beside_threads_there_is_none() -> None:
    """A library of the user's, or of an embedding program, may have started them."""
    done = Event()
    with ThreadPoolExecutor(1) as threads:
        threads.submit(done.wait)
        try:
            assert forked(()) is None
        finally:
            done.set()


def test_where_threads_cannot_be_counted_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """A container may have no /proc."""
    monkeypatch.setattr(os, "listdir", lambda _: os.open("/nowhere", os.O_RDONLY))
    assert forked(()) is None


def test_it_ends_where_nobody_is_told_of_an_end() -> None:
    """``SIGCHLD`` that is ignored passes on to a program; a service that waited for ever had to be killed."""
    ours, theirs = socket.socketpair()
    before = signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    try:
        with ours, theirs:
            child = Child(theirs, (ours,))
            assert child.poll() is None
            child.kill()
            assert child.wait(PATIENCE_S) is not None
            assert child.poll() is not None
    finally:
        signal.signal(signal.SIGCHLD, before)


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGINT])
def test_a_service_ends_whose_parent_ignored_ends(how: signal.Signals, tmp_path: Path) -> None:
    before = signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    try:
        served = Served(tmp_path)
    finally:
        signal.signal(signal.SIGCHLD, before)
    try:
        assert served.heavy() == 200
        served.process.send_signal(how)
        served.process.wait(PATIENCE_S)
    finally:
        served.process.kill()


def test_several_threads_learn_of_its_end() -> None:
    """The system tells it once: a second one that asked heard that the child lives."""
    ours, theirs = socket.socketpair()
    with ours, theirs:
        child = Child(theirs, (ours,))
        assert child.poll() is None
        with pytest.raises(subprocess.TimeoutExpired):
            child.wait(0.05)
        with ThreadPoolExecutor(8) as threads:
            waits = [threads.submit(child.wait, PATIENCE_S) for _ in range(8)]
            child.kill()
            assert {one.result() for one in waits} == {-signal.SIGKILL}
        assert child.poll() == child.wait() == -signal.SIGKILL
