"""The sweep: filter steps against OSQP, 500 cases, cost against case count; by hand many cases, workers and kills.

``python -m benchmarks.sweep`` measures what ``safestart bench`` shows. By hand, each printing one JSON document:

- ``python -m benchmarks.sweep cases 1000000 [exact]``: one process, seconds and memory;
- ``python -m benchmarks.sweep workers 200000``: one task process against two, on a real worker;
- ``python -m benchmarks.sweep chaos 100000 3``: task processes and workers killed with SIGKILL, the aggregate compared.
"""

from __future__ import annotations

import json
import random
import resource
import tempfile
import time
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.asked import parser
from benchmarks.peers.osqp_loop import OsqpLoop
from benchmarks.timing import side_by_side
from safestart.control.forecast import flight_plan
from safestart.control.gains import TUNED
from safestart.model.scenario import Rest, Scenario
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.records.comparable import comparable
from safestart.runtime.progress import Context
from safestart.simulation.compiled_loop import fly
from safestart.simulation.noise import CONTINUOUS, Truth
from safestart.simulation.starts import start_states
from tests.waiting import until

FILTER: dict[str, Any] = {"controllers": ["filter"], "certificates": ["closed_form"]}
CELLS = 60
SIZES = (6_000, 30_000, 120_000)
TRUTH = Truth(CONTINUOUS)


def shards_s(inputs: dict[str, Any]) -> tuple[float, float]:
    """Seconds of all shards of a sweep in this process, on the wall and on the processor."""
    spec = process("sweep")
    assert spec.sharding is not None
    parts = spec.sharding.parts(spec.parse(inputs))
    wall, used = time.perf_counter(), time.process_time()
    for part in parts:
        spec.sharding.run_part(part, Context())
    return time.perf_counter() - wall, time.process_time() - used


def measure(runs: int = 5) -> dict[str, dict[str, float]]:
    """Ratio per control step to OSQP from Python, time of 540 cases, and how evenly the cost grows."""
    scenario = Scenario.of(1.0, 0.1)
    rng = np.random.default_rng(0)
    points = np.stack([rng.uniform(-30, 30, 200), rng.uniform(35, 120, 200)], axis=1)
    starts = start_states(scenario, points, Rest.LVLH)
    plan = flight_plan(scenario, TUNED, 2.0, 30)
    flights = fly(plan, starts, TRUTH)
    clean = starts[np.flatnonzero(flights.safe & (flights.fallbacks == 0))[:10]]
    peer, many = OsqpLoop(scenario, TUNED, 2.0, 30), np.tile(clean, (200, 1))
    steps = 30 * len(clean)
    own, other = side_by_side(lambda: fly(plan, many, TRUTH), lambda: peer.fly_all(clean), runs)

    shards_s(FILTER)
    small = median(shards_s(FILTER)[0] for _ in range(runs))
    flown = {"cases_per_cell": 1, "certificates": []}
    shards_s(flown)  # compiles
    sequence = shards_s(flown)[0] * 9
    each = []
    for size in SIZES:
        used = min(shards_s({**FILTER, "cases_per_cell": size // CELLS, "records": 0})[1] for _ in range(3))
        each.append(used / size)
    return {
        "ratios": {
            "sweep_filter_vs_osqp": 200 * other / own,
            "sweep_cost_largest_over_smallest": each[-1] / each[0],
        },
        "times": {
            "sweep_filter_step_s": own / (200 * steps),
            "sweep_filter_540_cases_s": small,
            "sweep_filter_and_sequence_540_cases_s": sequence,
            "sweep_filter_case_s": each[-1],
        },
    }


def cases(count: int, *more: str) -> dict[str, Any]:
    """One big sweep in this process."""
    inputs = FILTER | {"cases_per_cell": -(-count // CELLS)}
    if "exact" in more:
        inputs["certificates"] = ["closed_form", "exact"]
    wall, used = time.perf_counter(), time.process_time()
    outputs = execute("sweep", inputs).document["outputs"]
    return {
        "cases": outputs["cases"],
        "wall_s": time.perf_counter() - wall,
        "processor_s": time.process_time() - used,
        "control_steps": outputs["control_steps"],
        "most_memory_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "confusion": outputs["confusion"],
        "false_go_count": outputs["false_go_count"],
    }


def workers(count: int) -> dict[str, Any]:
    """The same job on a worker with one task process and with two."""
    inputs = FILTER | {"cases_per_cell": -(-count // CELLS)}
    seconds: dict[int, float] = {}
    for processes in (1, 2):
        with _farm(processes) as farm:
            farm.ended(farm.submit("sweep", FILTER), 600)
            until(lambda at=farm: "every process holds" in at.said(), "modules and kernels")
            begin = time.perf_counter()
            farm.ended(farm.submit("sweep", inputs), 3600)
            seconds[processes] = time.perf_counter() - begin
    return {"seconds": seconds, "speedup": seconds[1] / seconds[2]}


def chaos(count: int, kills: int) -> dict[str, Any]:
    """Kill task processes and, every third time, the worker itself, while a sweep runs."""
    inputs = FILTER | {
        "controllers": ["filter", "filter_fine"],
        "cases_per_cell": -(-count // CELLS),
        "seed": 5,
    }
    spec = process("sweep")
    assert spec.sharding is not None
    total = len(spec.sharding.parts(spec.parse(inputs)))
    choice = random.Random(0)
    with _farm(2) as farm:
        job = farm.submit("sweep", inputs)
        killed = []
        for kill in range(kills):
            until(
                lambda n=kill: len(farm.jobs.shard_contents(job)) >= (n + 1) * total // (kills + 2),
                "the next shards",
                1800.0,
            )
            if kill % 3 == 2:
                farm.worker.kill()
                farm.worker.wait()
                farm.lapse()
                killed.append("worker")
                farm.start()
            else:
                tasks = [p for p in farm.processes() if "spawn_main" in " ".join(p.cmdline())]
                choice.choice(tasks).kill()
                killed.append("task process")
        ended = farm.ended(job, 3600)
        there = farm.results.result(job).document
        notes = [event.data["message"] for event in farm.jobs.events(job) if event.kind == "log"]
    here = execute("sweep", inputs).document
    return {
        "shards": total,
        "killed": killed,
        "status": ended.status.value,
        "notes": notes,
        "same_aggregate": comparable(there["outputs"]) == comparable(here["outputs"]),
        "same_files": there["provenance"]["artifacts"] == here["provenance"]["artifacts"],
    }


class _farm:
    """A worker of the acceptance tests, in a separate folder."""

    def __init__(self, processes: int) -> None:
        self.processes = processes

    def __enter__(self) -> Any:
        from tests.acceptance.worker_process import Farm

        self.farm = Farm(Path(tempfile.mkdtemp()), self.processes, "all")
        self.farm.start()
        return self.farm

    def __exit__(self, *_: object) -> None:
        self.farm.close()


if __name__ == "__main__":
    asked = parser(__doc__)
    studies = asked.add_subparsers(dest="study")
    for name in ("cases", "workers", "chaos"):
        studies.add_parser(name).add_argument("count", type=int)
    studies.choices["cases"].add_argument("certificates", nargs="?", choices=("exact",))
    studies.choices["chaos"].add_argument("kills", type=int)
    given = asked.parse_args()
    if given.study is None:
        found: dict[str, Any] = measure()
    elif given.study == "cases":
        found = cases(given.count, *filter(None, [given.certificates]))
    elif given.study == "workers":
        found = workers(given.count)
    else:
        found = chaos(given.count, given.kills)
    print(json.dumps(found, indent=2))
