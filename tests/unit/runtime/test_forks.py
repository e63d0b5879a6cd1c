"""Locks of a process that forks."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread

import pytest

from safestart.processes.go_no_go import atlases
from safestart.runtime import precision
from safestart.runtime.children.forks import ForkableLock
from tests.waiting import PATIENCE_S, until

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="nothing forks there")

LOCKS = {"alone": ForkableLock(), "precision": precision._LOCK, "atlases": atlases._lock}


@contextmanager
def held(lock: ForkableLock) -> Iterator[None]:
    """Another thread has taken it."""
    taken, done = Event(), Event()

    def hold() -> None:
        with lock:
            taken.set()
            done.wait(PATIENCE_S)

    thread = Thread(target=hold)
    thread.start()
    assert taken.wait(PATIENCE_S)
    try:
        yield
    finally:
        done.set()
        thread.join()


@pytest.mark.parametrize("name", LOCKS)
@pytest.mark.filterwarnings("ignore:os.fork:RuntimeWarning", "ignore:This process:DeprecationWarning")
def test_a_child_waits_for_no_thread_of_its_parent(name: str) -> None:
    lock = LOCKS[name]
    with held(lock):
        child = os.fork()
        if child == 0:
            with lock:
                os._exit(7)
        ended: list[int] = []

        def gone() -> bool:
            process, status = os.waitpid(child, os.WNOHANG)
            ended.extend([os.waitstatus_to_exitcode(status)] * (process == child))
            return bool(ended)

        try:
            assert until(gone, "the child's end")
        finally:
            if not ended:
                os.kill(child, 9)
                os.waitpid(child, 0)
    assert ended == [7]


def test_it_is_a_lock_that_its_own_thread_takes_again() -> None:
    lock, entered = ForkableLock(), Event()

    def enter() -> None:
        with lock:
            entered.set()

    with lock, lock:
        other = Thread(target=enter)
        other.start()
        assert not entered.wait(0.05)
    other.join(PATIENCE_S)
    assert entered.is_set()
