"""How much faster two task processes fly a sweep than one, on a real worker: 1 000 000 flights in shards.

``python -m benchmarks.sweep workers COUNT`` is the same for any number of flights.
"""

from __future__ import annotations

from benchmarks.sweep import workers

FLIGHTS = 1_000_000


def measure() -> dict[str, dict[str, float]]:
    """One run of each, kernels compiled before."""
    found = workers(FLIGHTS)
    seconds = found["seconds"]
    return {
        "ratios": {"sweep_two_workers": found["speedup"]},
        "times": {"sweep_one_worker_s": seconds[1], "sweep_two_workers_s": seconds[2]},
    }
