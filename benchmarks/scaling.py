"""What limits a sweep of 10^9 flights on 1 000 cores? Service times measured here, the cluster simulated.

``python -m benchmarks.scaling [FLIGHTS]`` measures one core's flights, what a shard costs besides, what scheduler
and worker spend on a task, and the store's transactions (``SAFESTART_TEST_POSTGRESQL`` names a server, else SQLite).
Then it simulates the worker's loop (``safestart_worker.jobs.shards``) on more and more cores, for shards of 10 000
flights and for those that very large sweeps have, each stored by itself or with all that ended meanwhile.
"""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import simpy
from distributed import Client, LocalCluster

from benchmarks.asked import parser
from benchmarks.sweep import FILTER
from benchmarks.timing import median_cpu, median_seconds
from safestart.campaign.part import Part
from safestart.processes.registry import process
from safestart.processes.sweep.split import FAST, MOST_SHARDS
from safestart.runtime.progress import Context
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.contract.store.store_backends import POSTGRESQL, fresh_url

CORES = (1, 2, 10, 100, 300, 1_000)
ONE_CELL = FILTER | {"omega_t_deg_s": [3.0], "a_max_m_s2": [0.1], "r0_m": [50.0], "records": 0}
AHEAD = 2
"""Shards that wait on the cluster for each core, as the worker keeps them."""


@dataclass(frozen=True)
class Times:
    """Seconds: a flight, a shard besides its flights, a task in scheduler and worker, a transaction and each of its
    rows, the merge of a shard.
    """

    flight: float
    shard: float
    task: float
    transaction: float
    row: float
    merge: float


@dataclass
class Cluster:
    """How long things were busy, s."""

    loop: float = 0.0
    store: float = 0.0
    cores: float = 0.0


def simulate(times: Times, cores: int, flights: int, per_shard: int, *, grouped: bool) -> dict[str, Any]:
    """The end of a sweep, s; its share of the cores' time that flies; what is busy how much of the time."""
    world, busy = simpy.Environment(), Cluster()
    core, loop, ended = simpy.Resource(world, cores), simpy.Resource(world, 1), simpy.Store(world)
    shards = -(-flights // per_shard)

    def in_loop() -> Iterator[Any]:
        # Scheduler and worker share a process, and with it one lock.
        with loop.request() as mine:
            yield mine
            busy.loop += times.task / 2
            yield world.timeout(times.task / 2)

    def task() -> Iterator[Any]:
        yield from in_loop()
        with core.request() as mine:
            yield mine
            took = times.shard + per_shard * times.flight
            busy.cores += took
            yield world.timeout(took)
        yield from in_loop()
        yield ended.put(1)

    def worker() -> Iterator[Any]:
        left, waiting, done = shards, 0, 0
        while done < shards:
            while left and waiting < AHEAD * cores:
                world.process(task())
                left, waiting = left - 1, waiting + 1
            yield ended.get()
            count = 1 + len(ended.items)
            ended.items.clear()
            waiting -= count
            stored = times.row * count + times.transaction * (1 if grouped else count)
            busy.store += stored
            yield world.timeout(stored)
            done += count

    world.run(world.process(worker()))
    end = world.now + times.merge * shards
    return {
        "cores": cores, "shards": shards, "grouped": grouped, "seconds": end,
        "efficiency": flights * times.flight / (cores * end),
        "busy": {"cores": busy.cores / cores / end, "scheduler": busy.loop / end, "store": busy.store / end,
                 "merge": times.merge * shards / end},
    }  # fmt: skip


def measured() -> Times:
    """The service times of this machine, one core."""
    flight, shard, part = _flights()
    transaction, row = _store(part)
    return Times(flight, shard, _task(), transaction, row, _merge())


def _flights() -> tuple[float, float, Part]:
    """Seconds of a flight and of a shard besides, and a shard's result; a shard of a large sweep has one cell."""
    spec = process("sweep")
    assert spec.sharding is not None
    counts, taken, done = (1_000, FAST), [], Part({})
    for count in counts:
        (part,) = spec.sharding.parts(spec.parse(ONE_CELL | {"cases_per_cell": count}))
        work = partial(spec.sharding.run_part, part, Context())
        taken.append(median_cpu(work, 7))
        done = work()
    flight = (taken[1] - taken[0]) / (counts[1] - counts[0])
    return flight, max(taken[0] - counts[0] * flight, 0.0), done


def _store(part: Part) -> tuple[float, float]:
    """Seconds of a transaction, and of each shard in it."""
    with tempfile.TemporaryDirectory() as folder:
        url = fresh_url("postgresql", Path(folder)) if POSTGRESQL else f"sqlite:///{folder}/scaling.sqlite3"
        database = Database(url)
        database.migrate()
        jobs = JobRepository(database)
        jobs.submit("sweep", {}, timeout_s=3600.0)
        claim = jobs.claim("scaling", 3600.0)
        assert claim is not None
        number = iter(range(10**9))

        def save(count: int) -> None:
            jobs.save_shards(
                claim, [(next(number), "c" * 64, part.document, part.data) for _ in range(count)]
            )

        one, many = median_seconds(lambda: save(1), 50), median_seconds(lambda: save(200), 10)
        database.close()
    row = max(many - one, 0.0) / 199
    return one - row, row


def _task() -> float:
    """Processor seconds of the process that holds scheduler and client, per task that does nothing."""
    tasks = 2_000
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="") as cluster,
        Client(cluster) as client,
    ):
        client.gather(client.map(_nothing, range(100), key="warm"))
        begun = time.process_time()
        client.gather(client.map(_nothing, range(tasks), key="counted"))
        return (time.process_time() - begun) / tasks


def _nothing(number: int) -> int:
    return number


def _merge() -> float:
    """Seconds of each shard more in the merge."""
    spec = process("sweep")
    assert spec.sharding is not None
    taken = []
    for shards in (10, 60):
        inputs = spec.parse(FILTER | {"cases_per_cell": shards * 100, "records": 0})
        parts = spec.sharding.parts(inputs)
        small = [
            part | {"pieces": [[cell, first, 50] for cell, first, _ in part["pieces"]]} for part in parts
        ]
        done = [spec.sharding.run_part(part, Context()) for part in small]
        taken.append(
            (len(parts), median_cpu(lambda i=inputs, d=done: spec.sharding.merged(i, d, Context()), 3))
        )
    (few, first), (many, last) = taken
    return max(last - first, 0.0) / (many - few)


def study(flights: int = 10**9) -> dict[str, Any]:
    """Measured times, and each way on each number of cores."""
    times = measured()
    large = max(FAST, -(-flights // MOST_SHARDS))
    ways = [(FAST, False), (FAST, True), (large, False), (large, True)]
    return {
        "times": asdict(times),
        "flights": flights,
        "runs": [
            simulate(times, cores, flights, size, grouped=grouped) | {"flights_per_shard": size}
            for size, grouped in ways
            for cores in CORES
        ],
    }


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("flights", nargs="?", type=lambda text: int(float(text)), default=10**9)
    print(json.dumps(study(asked.parse_args().flights), indent=1))
