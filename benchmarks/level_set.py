"""Our level-set solver beside hj-reachability on one core, and both beside what the core could do.

The paper's tube (body frame, 3 deg/s, 0.10 m/s^2, 41 x 41 x 15 x 15, T = 4 s, float32), stepping only: compilation,
set-up and reading the slice are not counted. Both run in one child process that holds a single core, so that neither
library can use more threads than the other; times are CPU seconds, which other load on the machine hardly touches.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.asked import parser

RUNS, PEER_RUNS = 9, 3
SPAN = 4.0
SCHEMES = {"low": (1, 66), "very_high": (3, 530)}
"""Stages of a step, and floating-point operations per node and stage as the kernel writes them (4 axes, disk)."""


def measure() -> dict[str, dict[str, float]]:
    """Ratios peer / ours per accuracy; times, and the share of the core's bandwidth and multiply-add rate reached."""
    root = Path(__file__).resolve().parents[1]
    child = subprocess.run(
        [sys.executable, "-m", "benchmarks.level_set"], cwd=root, check=True, capture_output=True, text=True
    )
    found: dict[str, dict[str, float]] = json.loads(child.stdout.splitlines()[-1])
    return found


def _cpu(work: Callable[[], Any]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def _limits() -> tuple[float, float]:
    """Bytes per second of a triad over arrays beyond the cache, and float32 multiply-adds (x 2) per second."""
    import numpy as np
    from numba import njit

    @njit(error_model="numpy", fastmath=True)
    def triad(a: Any, b: Any, c: Any) -> None:
        for j in range(len(a)):
            a[j] = b[j] + a.dtype.type(0.5) * c[j]

    @njit(error_model="numpy", fastmath={"contract"})
    def multiply_add(x: Any, rounds: int) -> None:
        # 256 independent chains hide the latency; the array stays in the first cache.
        for _ in range(rounds):
            for j in range(256):
                y = x[j]
                for _ in range(16):
                    y = y * x.dtype.type(0.999) + x.dtype.type(0.001)
                x[j] = y

    size = 30_000_000
    a, b, c = (np.ones(size, np.float32) for _ in range(3))
    x = np.ones(256, np.float32)
    triad(a, b, c)
    multiply_add(x, 1)
    bandwidth = 12.0 * size / min(_cpu(lambda: triad(a, b, c)) for _ in range(5))
    rounds = 100_000
    flops = rounds * 256 * 16 * 2 / min(_cpu(lambda: multiply_add(x, rounds)) for _ in range(5))
    return bandwidth, flops


def _run() -> dict[str, dict[str, float]]:
    from safestart.engines.base import Problem
    from safestart.engines.hj.domain import count_steps, size_domain
    from safestart.engines.hj.fused import FusedSolver
    from safestart.engines.hj.options import HamiltonJacobiInput
    from safestart.engines.hj.peer import PeerSolver
    from safestart.engines.hj.settings import Settings
    from safestart.engines.hj.target import TargetValues
    from safestart.model.scenario import Scenario, SetKind

    bandwidth, peak = _limits()
    ratios: dict[str, float] = {}
    times = {"triad_bytes_per_s": bandwidth, "multiply_add_flops_per_s": peak}
    for accuracy, (stages, work) in SCHEMES.items():
        options = HamiltonJacobiInput.model_validate({"accuracy": accuracy, "frame": "body"})
        problem = Problem(Scenario.of(3.0, 0.1), horizon=SPAN, kind=SetKind.TUBE)
        settings = Settings.of(problem, options)
        domain = size_domain(problem, settings.frame)
        steps, courant = count_steps(problem, domain, settings)
        terminal = TargetValues.of(problem, domain, settings).terminal
        kinds = (FusedSolver, PeerSolver)
        ours, peer = (kind(problem, domain, settings, terminal, courant) for kind in kinds)
        ours.advance(SPAN)
        peer.advance(SPAN)
        fast: list[float] = []
        slow: list[float] = []
        for _ in range(PEER_RUNS):
            fast += [_cpu(partial(ours.advance, SPAN)) for _ in range(RUNS // PEER_RUNS)]
            slow.append(_cpu(partial(peer.advance, SPAN)))
        per_node = median(fast) / (steps * stages * terminal.size)
        ratios[f"hj_fused_{accuracy}"] = median(slow) / median(fast)
        times[f"hj_fused_{accuracy}_s"] = median(fast)
        times[f"hj_reachability_{accuracy}_s"] = median(slow)
        # A stage reads the value once and writes it once; the later stages of Runge-Kutta read the first value too.
        moved = 4.0 * (2.0 + (stages - 1) / stages)
        times[f"hj_fused_{accuracy}_share_of_bandwidth"] = moved / per_node / bandwidth
        times[f"hj_fused_{accuracy}_share_of_multiply_add"] = work / per_node / peak
    return {"ratios": ratios, "times": times}


if __name__ == "__main__":
    parser(__doc__).parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    print(json.dumps(_run()))
