"""The safe-abort map of 1000 starts and 48 windows over Dask: ``python -m benchmarks.safe_abort_map [STARTS]``.

Two workers of one thread each, tables of exponentials included. By hand: about half a minute on two idle cores.
"""

from __future__ import annotations

import os
import time

from dask.distributed import Client, LocalCluster

from benchmarks.asked import parser
from safestart.processes.registry import process
from safestart.processes.sharding import Part, Sharding
from safestart.runtime.progress import Context

WORKERS = 2


def shard(sharding: Sharding, part: dict[str, object]) -> tuple[Part, float]:
    """One shard and its CPU seconds."""
    start = time.process_time()
    return sharding.run_part(part, Context()), time.process_time() - start


def main(starts: int) -> None:
    """Print wall and CPU seconds, and how many starts are proved to the end."""
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    spec = process("safe-abort-map")
    inputs = spec.parse({"arc": {"rings": 4, "angles": starts // 4}})
    assert spec.sharding is not None
    parts = spec.sharding.parts(inputs)
    with (
        LocalCluster(n_workers=WORKERS, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        begin = time.perf_counter()
        done = client.gather(client.map(shard, [spec.sharding] * len(parts), parts))
        wall = time.perf_counter() - begin
    output = spec.sharding.merged(inputs, [part for part, _ in done], Context())
    cpu = sum(seconds for _, seconds in done)
    proved = output.document["all_proved_until_min"]
    print(
        f"{len(proved)} starts, 48 windows, {WORKERS} workers: {wall:.1f} s, {cpu:.1f} s of CPU; proved to 240 min: "
        f"{sum(value == 240.0 for value in proved)}"
    )


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("starts", nargs="?", type=int, default=1000)
    given = asked.parse_args()
    main(given.starts)
