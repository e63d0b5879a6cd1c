"""How every benchmark times: warm, median, both sides in turn."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any


def once(work: Callable[[], Any]) -> float:
    """Seconds of one call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def median_seconds(work: Callable[[], Any], runs: int) -> float:
    """Median of ``runs`` calls after one warm-up."""
    work()
    return statistics.median(once(work) for _ in range(runs))


def median_cpu(work: Callable[[], Any], runs: int) -> float:
    """Median of the processor seconds of this process, after one warm-up: hardly touched by others on the machine."""

    def spent() -> float:
        start = time.process_time()
        work()
        return time.process_time() - start

    work()
    return statistics.median(spent() for _ in range(runs))


def side_by_side(ours: Callable[[], Any], peer: Callable[[], Any], runs: int) -> tuple[float, float]:
    """Medians of both, run A B A B after one warm-up of each, so that a drift of the machine hits both."""
    ours()
    peer()
    pairs = [(once(ours), once(peer)) for _ in range(runs)]
    return statistics.median(a for a, _ in pairs), statistics.median(b for _, b in pairs)
