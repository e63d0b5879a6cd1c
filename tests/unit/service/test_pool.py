"""Helper processes: forked from one that has loaded, killed when nobody waits, gone when their service is."""

from __future__ import annotations

import asyncio
import operator
import os
import signal
import time
from collections.abc import Awaitable, Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Any

import psutil
import pytest

from safestart.errors import Unavailable
from safestart.runtime.settings import Settings
from safestart_service.computing import inside
from safestart_service.computing.helpers import nursery, serving, sources
from safestart_service.computing.helpers import pool as pool_module
from safestart_service.computing.helpers.pool import Pool
from safestart_service.computing.helpers.process import HelperEnded
from safestart_service.computing.helpers.sources import FORKS, Forked, Source, Spawned
from tests.waiting import PATIENCE_S, ended, until

needs_fork = pytest.mark.skipif(not FORKS, reason="this system cannot fork")


class Shared(Forked):
    """One for all tests, as loading takes seconds: the end of a pool is not the end of it."""

    def close(self) -> None:
        pass


@pytest.fixture(scope="module")
def source() -> Iterator[Source]:
    found = Shared()
    yield found
    Forked.close(found)


def asked(source: Source, work: Callable[[Pool], Awaitable[None]]) -> None:
    async def all_of_it() -> None:
        pool = Pool(2, source)
        try:
            await work(pool)
        finally:
            pool.close()

    asyncio.run(all_of_it())


@needs_fork
def test_a_helper_is_kept_and_another_one_comes_beside_it(source: Source) -> None:
    asked(source, _kept)


def test_the_same_where_a_system_cannot_fork() -> None:
    asked(Spawned(), _kept)


async def _kept(pool: Pool) -> None:
    await pool.start()
    first = await pool(os.getpid)
    assert first != os.getpid()
    assert await pool(os.getpid) == first
    both = await asyncio.gather(pool(_pid_after, 0.5), pool(_pid_after, 0.5))
    assert first in both
    assert len(set(both)) == 2
    assert await pool(operator.add, [1], [2.5]) == [1, 2.5]
    with pytest.raises(ZeroDivisionError):
        await pool(operator.truediv, 1, 0)
    assert await pool(os.getpid) in both


@needs_fork
def test_a_cancelled_call_ends_its_process_and_the_next_one_is_served(source: Source) -> None:
    async def work(pool: Pool) -> None:
        first = await pool(os.getpid)
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(pool(time.sleep, 600), 0.2)
        assert await pool(os.getpid) != first
        assert until(lambda: ended(first), "the end of the process")

    asked(source, work)


@needs_fork
def test_a_process_that_ends(source: Source) -> None:
    """In a call it is told; between calls another one takes its place."""

    async def work(pool: Pool) -> None:
        with pytest.raises(HelperEnded):
            await pool(os._exit, 3)
        first = await pool(os.getpid)
        os.kill(first, signal.SIGKILL)
        assert until(lambda: ended(first), "the end of the process")
        assert await pool(os.getpid) != first

    asked(source, work)


@needs_fork
def test_what_cannot_be_sent_back_ends_the_process_alone(source: Source) -> None:
    async def work(pool: Pool) -> None:
        with pytest.raises(HelperEnded):
            await pool(eval, "lambda: 0")
        with pytest.raises(Exception, match="pickle"):
            await pool(lambda: 0)
        assert await pool(abs, -1) == 1

    asked(source, work)


@needs_fork
def test_closed_while_one_computes(source: Source) -> None:
    pids: list[int] = []

    async def work(pool: Pool) -> None:
        pids.append(await pool(os.getpid))
        call = asyncio.ensure_future(pool(time.sleep, 600))
        await asyncio.sleep(0.1)
        pool.close()
        with pytest.raises(HelperEnded):
            await call

    asked(source, work)
    assert until(lambda: ended(pids[0]), "the end of the process")


@needs_fork
def test_a_nursery_that_ends_is_replaced() -> None:
    others, source = _nurseries(), Forked()

    async def work(pool: Pool) -> None:
        assert await pool(abs, -1) == 1
        (pid,) = _nurseries() - others
        os.kill(pid, signal.SIGKILL)
        assert until(lambda: ended(pid), "the end of the process")
        # The helper that it has forked lives on; two at once need a new one.
        assert await asyncio.gather(pool(_after, 0.3, 5), pool(_after, 0.3, 6)) == [5, 6]
        assert len(_nurseries() - others) == 1

    try:
        asked(source, work)
    finally:
        source.close()
    assert _nurseries() == others
    with pytest.raises(HelperEnded):
        source.helper()


@needs_fork
def test_a_nursery_that_hangs_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    others, source = _nurseries(), Forked()

    async def work(pool: Pool) -> None:
        first = await pool(os.getpid)
        (pid,) = _nurseries() - others
        os.kill(pid, signal.SIGSTOP)
        os.kill(first, signal.SIGKILL)
        assert until(lambda: ended(first), "the end of the process")
        assert await pool(abs, -1) == 1
        assert pid not in _nurseries()

    monkeypatch.setattr(sources, "FORK_S", 0.5)
    try:
        asked(source, work)
    finally:
        source.close()


@needs_fork
def test_the_end_of_each_helper_is_seen_that_was_asked_for_with_others() -> None:
    """One that was forked with the ends of those that still waited kept them open: the pool gave calls to the dead."""
    others, source = _nurseries(), Forked()
    try:
        first = source.helper()
        (pid,) = _nurseries() - others
        os.kill(pid, signal.SIGSTOP)
        with ThreadPoolExecutor(4) as threads:
            asked_for = [threads.submit(source.helper) for _ in range(4)]
            time.sleep(0.3)
            os.kill(pid, signal.SIGCONT)
            helpers = [one.result() for one in asked_for]
        for killed in (*helpers[1:], helpers[0], first):
            assert not killed.ended()
            killed.kill()
            assert until(killed.ended, "the end of a helper", 20.0)
    finally:
        source.close()


@needs_fork
def test_a_call_that_stops_when_nobody_waits_keeps_its_process(
    source: Source, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pool_module, "GRACE_S", PATIENCE_S)  # beside others it takes a while to stop

    async def work(pool: Pool) -> None:
        first = await pool(os.getpid)
        for _ in range(3):
            with pytest.raises(TimeoutError):
                await asyncio.wait_for(pool(_until_stopped), 0.2)
            assert await pool(serving.stopped) is False, "the next call is wanted"
        assert await pool(os.getpid) == first

    asked(source, work)


@needs_fork
def test_a_helper_that_keeps_much_memory_is_not_kept(source: Source) -> None:
    """Whether its call returns, fails, or stops when nobody waits. What a call lets go of does not count."""

    async def work(pool: Pool) -> None:
        first = await pool(os.getpid)
        await pool(exec, HOLD.format(2, 1))
        assert await pool(len, b"1" * 40_000_000) == 40_000_000
        assert await pool(os.getpid) == first
        await pool(exec, HOLD.format(40, 1))
        second = await pool(os.getpid)
        with pytest.raises(ZeroDivisionError):
            await pool(exec, HOLD.format(40, 0))
        third = await pool(os.getpid)
        assert len({first, second, third}) == 3
        assert until(lambda: ended(first) and ended(second), "the end of both")

    asked(source, work)


@needs_fork
def test_no_call_begins_after_the_end(source: Source) -> None:
    async def work(pool: Pool) -> None:
        pool.close()
        with pytest.raises(HelperEnded):
            await pool(abs, -1)

    asked(source, work)


def test_no_memory_for_what_an_answer_needs_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def none_left(settings: Settings) -> None:
        raise MemoryError

    monkeypatch.setattr(inside, "_prepare", lambda: None)  # else this process had less memory from here on
    monkeypatch.setattr(inside, "_store", none_left)
    with pytest.raises(Unavailable, match="smaller question"):
        inside.call(abs, Settings())


def _nurseries() -> set[int]:
    """Process ids of those that are ours and live."""
    found = set()
    for one in psutil.Process().children():
        with suppress(psutil.Error):  # it has just ended
            if nursery.__name__ in one.cmdline():
                found.add(one.pid)
    return found


# As text: a helper that imported this module would keep the memory of pytest.
HOLD = "import builtins; builtins.held = b'1' * {} * 1_000_000; 1 / {}"


def _pid_after(wait_s: float) -> int:
    time.sleep(wait_s)
    return os.getpid()


def _after(wait_s: float, answer: Any) -> Any:
    time.sleep(wait_s)
    return answer


def _until_stopped() -> None:
    while not serving.stopped():
        time.sleep(0.01)
