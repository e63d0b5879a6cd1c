"""A job waits for its own kernels only; a worker whose warm-up failed takes no jobs."""

import asyncio
from typing import cast

import pytest
from distributed import KilledWorker
from distributed.client import FutureCancelledError

from safestart.processes.registry import PROCESS_IDS, process
from safestart.runtime.kernels.warmup import PARTS
from safestart_worker.cluster.cluster import Cluster
from safestart_worker.warming import Kernels

BENCHMARK = process("benchmark").kernels
PARTS_ORDER = list(PARTS)


class Processes:
    """A cluster that compiles a part when it is told to."""

    embedded = True

    def __init__(self) -> None:
        self.begun: list[str] = []
        self.ends: dict[str, asyncio.Future[None]] = {}
        self.everywhere = 0

    async def compile(self, part: str) -> None:
        self.begun.append(part)
        self.ends[part] = asyncio.get_running_loop().create_future()
        await self.ends[part]

    async def warm_all(self) -> None:
        self.everywhere += 1

    async def end(self, part: str, error: Exception | None = None) -> None:
        if error is None:
            self.ends[part].set_result(None)
        else:
            self.ends[part].set_exception(error)
        await settled()


async def settled() -> None:
    for _ in range(5):
        await asyncio.sleep(0)


def over(cluster: Processes) -> Kernels:
    return Kernels(cast(Cluster, cluster))


def test_every_process_names_parts_that_there_are() -> None:
    assert {part for name in PROCESS_IDS for part in process(name).kernels} <= set(PARTS)
    assert BENCHMARK


async def waiting_job() -> None:
    cluster = Processes()
    kernels = over(cluster)
    changes = 0

    def changed() -> None:
        nonlocal changes
        changes += 1

    kernels.on_change = changed
    last = PARTS_ORDER[-1]
    needs = next(name for name in PROCESS_IDS if process(name).kernels == (last,))
    assert not kernels.there(needs)
    kernels.go_on(2)
    await settled()
    assert cluster.begun == [last]  # the other process stays free for the job
    await cluster.end(last)
    assert changes == 1
    assert kernels.there(needs)
    kernels.go_on(1)  # the job runs on one of two
    await settled()
    assert cluster.begun == [last, PARTS_ORDER[0]]


def test_the_parts_of_a_waiting_job_come_first_and_alone() -> None:
    asyncio.run(waiting_job())


async def nothing_waits() -> None:
    cluster = Processes()
    kernels = over(cluster)
    for part in PARTS_ORDER:
        assert not kernels.over
        kernels.go_on(2)
        await settled()
        assert len([end for end in cluster.ends.values() if not end.done()]) <= 2
        await cluster.end(part)
    assert cluster.begun == PARTS_ORDER
    assert kernels.over
    assert cluster.everywhere == 1
    assert kernels.there("benchmark")
    assert kernels.there("no such process")


def test_without_jobs_all_parts_are_compiled_in_order_then_loaded_everywhere() -> None:
    asyncio.run(nothing_waits())


async def no_room() -> None:
    cluster = Processes()
    kernels = over(cluster)
    kernels.go_on(0)
    kernels.go_on(-1)
    await settled()
    assert not cluster.begun


def test_busy_task_processes_compile_nothing() -> None:
    asyncio.run(no_room())


async def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    kernels = over(Processes())
    assert not kernels.there("benchmark")
    monkeypatch.setattr(kernels, "_patience_s", 0.0)
    assert kernels.over
    assert kernels.there("benchmark")


def test_a_job_does_not_wait_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    asyncio.run(impatient(monkeypatch))


async def broken() -> Kernels:
    cluster = Processes()
    kernels = over(cluster)
    kernels.go_on(1)
    await settled()
    await cluster.end(PARTS_ORDER[0], RuntimeError("cannot cache function 'march'"))
    return kernels


def test_a_part_that_cannot_be_compiled_ends_the_worker(caplog: pytest.LogCaptureFixture) -> None:
    assert asyncio.run(broken()).failed
    assert "takes no jobs and ends" in caplog.text
    assert "cannot cache function" in caplog.text


async def killed(error: Exception) -> Kernels:
    cluster = Processes()
    kernels = over(cluster)
    kernels.go_on(1)
    await settled()
    await cluster.end(PARTS_ORDER[0], error)
    kernels.go_on(1)
    await settled()
    assert cluster.begun == PARTS_ORDER[:2]
    return kernels


@pytest.mark.parametrize("error", [KilledWorker("task", None, 3), FutureCancelledError("task", "lost")])
def test_a_process_that_is_killed_beside_a_job_does_not_end_the_worker(error: Exception) -> None:
    assert not asyncio.run(killed(error)).failed


class NotLoading(Processes):
    async def warm_all(self) -> None:
        raise ImportError("no module")


async def last_part(cluster: Processes) -> Kernels:
    kernels = Kernels(cast(Cluster, cluster), ("flights",))
    kernels.go_on(1)
    await settled()
    await cluster.end("flights")
    await settled()
    return kernels


def test_what_cannot_be_loaded_ends_the_worker(caplog: pytest.LogCaptureFixture) -> None:
    cluster = NotLoading()
    assert asyncio.run(last_part(cluster)).failed
    assert "modules and kernels: warming up failed" in caplog.text


async def only_what_is_needed() -> None:
    cluster = Processes()
    kernels = Kernels(cast(Cluster, cluster), ahead=False)
    kernels.go_on(2)
    await settled()
    assert cluster.begun == []
    assert not kernels.there("benchmark")
    for _ in BENCHMARK:
        kernels.go_on(1)
        await settled()
        await cluster.end(cluster.begun[-1])
    assert sorted(cluster.begun) == sorted(BENCHMARK)
    assert kernels.there("benchmark")
    kernels.go_on(2)
    await settled()
    assert len(cluster.begun) == len(BENCHMARK), "nothing waits for the others"
    assert cluster.everywhere == 0


def test_a_worker_may_compile_only_what_the_next_job_needs() -> None:
    asyncio.run(only_what_is_needed())
