"""Run the shards of a process side by side in processes of this machine; the result is that of :func:`execute`."""

from __future__ import annotations

import multiprocessing
import os
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from datetime import UTC, datetime
from typing import Any

from safestart.processes.execute import Execution, execute, merge
from safestart.processes.registry import process
from safestart.processes.sharding import Part
from safestart.runtime.progress import Context


def execute_side_by_side(
    process_id: str, inputs: Any, context: Context | None = None, workers: int | None = None
) -> Execution:
    """As :func:`execute`, with as many shards at a time as there are cores; raises as it does."""
    spec, context = process(process_id), context or Context()
    count = workers or os.cpu_count() or 1
    if spec.sharding is None or count == 1:
        return execute(process_id, inputs, context)
    parsed, started = spec.parse(inputs), datetime.now(UTC)
    parts = spec.sharding.parts(parsed)
    # A fresh interpreter for each: a forked one would have the locks of this one's threads.
    pool = ProcessPoolExecutor(min(count, len(parts)), multiprocessing.get_context("spawn"))
    try:
        waiting = {pool.submit(_one, process_id, part): index for index, part in enumerate(parts)}
        done: dict[int, Part] = {}
        while waiting:
            ended, _ = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for one in ended:
                done[waiting.pop(one)] = one.result()
            context.step(len(done), len(parts) + 1, f"{len(done)} of {len(parts)} shards")
        return merge(process_id, parsed, [done[index] for index in range(len(parts))], started, context)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _one(process_id: str, part: dict[str, Any]) -> Part:
    sharding = process(process_id).sharding
    assert sharding is not None
    return sharding.run_part(part, Context())
