"""A sweep on a Dask cluster that is far away, beside the same one near: ``python -m benchmarks.far_cluster [SHARDS]``.

Scheduler and Dask workers are processes of their own. Far, every connection to a scheduler or a worker goes through a
relay that holds each byte back for half of ``--round-trip-ms`` and, for ``--loss`` of the segments, for a
retransmission more (what TCP makes of a lost segment). A kernel with netem would do the same below TCP. The results of
both must be equal; printed are seconds, and the rate far over near.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import random
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from benchmarks.own_group import own_group
from safestart.processes.registry import process
from safestart.processes.sweep.split import SLOW
from safestart.records.comparable import comparable
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.results import ResultRepository
from safestart.store.records import JobStatus
from tests.waiting import accepts, free_port, until

SEGMENT = 1448
"""Bytes of a segment."""
RETRANSMIT_S = 0.2
"""The least timeout of Linux before it sends a lost segment again."""
LIMIT_S = 900.0


class Relay:
    """Passes on what comes to ``port``, late; runs until the process ends."""

    def __init__(self, target: int, delay_s: float, loss: float) -> None:
        self.port, self._target, self._delay, self._loss = free_port(), target, delay_s, loss
        self._draw = random.Random(target)
        threading.Thread(target=asyncio.run, args=(self._serve(),), daemon=True).start()
        until(lambda: accepts(self.port), "a relay that listens")

    async def _serve(self) -> None:
        async with await asyncio.start_server(self._joined, "127.0.0.1", self.port) as server:
            await server.serve_forever()

    async def _joined(self, near: asyncio.StreamReader, back: asyncio.StreamWriter) -> None:
        try:
            far, out = await asyncio.open_connection("127.0.0.1", self._target)
        except OSError:
            back.close()
            return
        await asyncio.gather(self._late(near, out), self._late(far, back), return_exceptions=True)

    async def _late(self, source: asyncio.StreamReader, sink: asyncio.StreamWriter) -> None:
        held: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue(1024)
        passing = asyncio.create_task(self._passed(held, sink))
        due = 0.0
        while data := await source.read(65536):
            lost = self._draw.random() > (1.0 - self._loss) ** -(-len(data) // SEGMENT)
            # What follows a lost segment waits for it.
            due = max(due, time.monotonic() + self._delay + (RETRANSMIT_S + 2 * self._delay if lost else 0.0))
            await held.put((due, data))
        await held.put((due, b""))
        await passing

    @staticmethod
    async def _passed(held: asyncio.Queue[tuple[float, bytes]], sink: asyncio.StreamWriter) -> None:
        while True:
            due, data = await held.get()
            await asyncio.sleep(max(due - time.monotonic(), 0.0))
            if not data:
                sink.close()
                return
            sink.write(data)
            await sink.drain()


@contextmanager
def cluster(folder: Path, workers: int, delay_s: float, loss: float) -> Iterator[Database]:
    """A scheduler, Dask workers and a safestart worker; the store that they work for."""
    url = f"sqlite:///{folder / 'far.sqlite3'}"
    database = Database(url)
    database.migrate()
    with ExitStack() as stack, (folder / "log").open("wb") as log:

        def start(*command: str) -> None:
            stack.enter_context(own_group([sys.executable, "-m", *command], stdout=log, stderr=log))

        def reached(port: int) -> int:
            return Relay(port, delay_s, loss).port if delay_s else port

        scheduler = free_port()
        start(
            "distributed.cli.dask_scheduler",
            "--host",
            "127.0.0.1",
            "--port",
            str(scheduler),
            "--no-dashboard",
        )
        until(lambda: accepts(scheduler), "a scheduler", log=folder / "log")
        address = f"tcp://127.0.0.1:{reached(scheduler)}"
        for _ in range(workers):
            port = free_port()
            start(
                "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard",
                "--listen-address", f"tcp://127.0.0.1:{port}",
                "--contact-address", f"tcp://127.0.0.1:{reached(port)}",
            )  # fmt: skip
        start("safestart_worker", "--database-url", url, "--scheduler", address)
        yield database


def timed(jobs: JobRepository, inputs: dict[str, Any]) -> tuple[float, str]:
    """Seconds from the submission of a sweep to its end, and its id."""
    begun = time.monotonic()
    job = jobs.submit("sweep", process("sweep").parse(inputs).model_dump(mode="json"), timeout_s=LIMIT_S).id
    until(lambda: jobs.get(job).status.ended, "the end of a sweep", LIMIT_S)
    if jobs.get(job).status is not JobStatus.SUCCESSFUL:
        raise RuntimeError(f"the sweep ended as {jobs.get(job).status}: {jobs.get(job).message}")
    return time.monotonic() - begun, job


def measure(shards: int, workers: int, delay_s: float, loss: float) -> dict[str, Any]:
    """Seconds near and far of a sweep of so many shards, each of 50 starts by the slow controller."""
    few = {
        "controllers": ["sequence"],
        "omega_t_deg_s": [2],
        "a_max_m_s2": [0.1],
        "r0_m": [50],
        "certificates": [],
    }
    seconds, documents = {}, []
    for name, late in (("near", 0.0), ("far", delay_s)):
        with tempfile.TemporaryDirectory() as folder, cluster(Path(folder), workers, late, loss) as database:
            jobs = JobRepository(database)
            timed(jobs, few | {"cases_per_cell": workers})  # modules and kernels
            seconds[name], job = timed(jobs, few | {"cases_per_cell": shards * SLOW})
            documents.append(comparable(ResultRepository(database).result(job).document["outputs"]))
    return {
        "seconds": seconds, "rate": seconds["near"] / seconds["far"], "same": documents[0] == documents[1],
        "shards": shards, "near_shard_s": seconds["near"] * workers / shards,
    }  # fmt: skip


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("shards", nargs="?", type=int, default=40)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--round-trip-ms", type=float, default=40.0)
    parser.add_argument("--loss", type=float, default=0.01)
    asked = parser.parse_args()
    found = measure(asked.shards, asked.workers, asked.round_trip_ms / 2000.0, asked.loss)
    print(json.dumps(found, indent=1))
