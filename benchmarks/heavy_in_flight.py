"""With twelve heavy requests in flight: how long a submission and a closed-form POST take.

``python -m benchmarks.heavy_in_flight`` starts a service of its own. Latencies are seconds; both are asked ten times a
second for twenty seconds.
"""

from __future__ import annotations

import asyncio
import time
from typing import Any

import httpx

from benchmarks.asked import parser
from benchmarks.worst_requests import POINT, service

HEAVY = 12
LASTS_S = 20.0
_EVERY_S = 0.1


async def _keep(client: httpx.AsyncClient, number: int, until: float) -> None:
    """One heavy request after another."""
    inputs = {**POINT, "horizon_s": 360 - 2 * number}
    while time.perf_counter() < until:
        await client.post("/processes/safe-region/execution", json={"inputs": inputs})


async def _latencies(client: httpx.AsyncClient, path: str, body: Any, until: float) -> list[float]:
    times = []
    while (begun := time.perf_counter()) < until:
        (await client.post(path, json=body)).raise_for_status()
        times.append(time.perf_counter() - begun)
        await asyncio.sleep(_EVERY_S)
    return sorted(times)


async def _all(address: str) -> dict[str, float]:
    until = time.perf_counter() + LASTS_S
    limits = httpx.Limits(max_connections=100)
    async with httpx.AsyncClient(base_url=address, timeout=120.0, limits=limits) as client:
        heavy = [asyncio.create_task(_keep(client, number, until)) for number in range(HEAVY)]
        await asyncio.sleep(1.0)
        job = {"inputs": {**POINT, "grid": {"nx": 31, "ny": 31}, "engines": ["analytical"]}}
        states = {**POINT, "method": "paper", "states": [{"x_m": 5, "y_m": 40 + k} for k in range(100)]}
        submitted, answered = await asyncio.gather(
            _latencies(client, "/processes/benchmark/execution", job, until),
            _latencies(client, "/go-no-go", states, until),
        )
        for task in heavy:
            task.cancel()
    return {
        f"{name}_{quantile}": times[int(quantile[1:]) * (len(times) - 1) // 100]
        for name, times in (("submission", submitted), ("closed_form", answered))
        for quantile in ("p50", "p95", "p99")
    }


def measure() -> dict[str, float]:
    """Latencies by name."""
    with service() as (address, _):
        return asyncio.run(_all(address))


if __name__ == "__main__":
    parser(__doc__).parse_args()
    print(measure())
