"""The largest legal request of every operation, one at a time and sixteen at once: memory, and health meanwhile.

``python -m benchmarks.worst_requests [CGROUP]`` starts a service of its own, in the memory control group CGROUP where
one is given (a folder with ``cgroup.procs``): whatever takes more than the group allows is killed.
Memory is the proportional set size of the service and its helper processes, so that what they share counts once
(``own_mb``: without mapped files); health is the time of ``GET /healthz``. Processes of their own measure both every
20 ms.
"""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

import httpx
import psutil

from benchmarks.asked import parser
from benchmarks.own_group import own_group
from benchmarks.worst_requests_watch import health, memory, watching
from safestart.store.database import Database
from tests.waiting import free_port

POINT = {"omega_t_deg_s": 3.14159265, "a_max_m_s2": 0.123456789}
TOGETHER = 16
_LONGEST_S = 300.0


def states(number: int) -> list[dict[str, float]]:
    """Starts whose text is long."""
    return [
        {"x_m": 1.2345678901 + 1e-7 * k, "y_m": 40.123456789, "z_m": 0.123456789012} for k in range(number)
    ]


def wrong(number: int) -> dict[str, int]:
    """Fields that are not known."""
    return {f"a{k}": 1 for k in range(number)}


def operations() -> dict[str, tuple[str, bytes, dict[str, str]]]:
    """Path, body and header fields of each, by name; the refused ones are the dearest that were found."""
    many = {**POINT, "states": states(100_000)}
    queued = {"Prefer": "respond-async"}
    asked: dict[str, tuple[str, Any, dict[str, str]]] = {
        "go-no-go, 100 000 starts": ("/go-no-go", many, {}),
        "the same, executed": ("/processes/go-no-go/execution", {"inputs": many}, {}),
        "the same, queued": ("/processes/go-no-go/execution", {"inputs": many}, queued),
        "certificate, 1000 x 1000": ("/certificates", {**POINT, "grid": {"nx": 1000, "ny": 1000}}, {}),
        "benchmark, 100 x 100": (
            "/processes/benchmark/execution",
            {"inputs": {**POINT, "grid": {"nx": 100, "ny": 100}}},
            {},
        ),
        "region, 300 s": ("/processes/safe-region/execution", {"inputs": {**POINT, "horizon_s": 300}}, {}),
        "350 000 unknown fields": ("/go-no-go", many | {"states": states(10)} | wrong(350_000), {}),
        "100 000 wrong starts": ("/go-no-go", {**POINT, "states": [{"b": 1}] * 100_000}, {}),
        "2.6 million empty starts": ("/go-no-go", {**POINT, "states": [{}] * 2_600_000}, {}),
        "a text of 7.9 MB": ("/go-no-go", {**POINT, "states": "x" * 7_900_000}, {}),
        "nested lists": ("/go-no-go", {**POINT, "states": [[[[]]]] * 120_000}, {}),
    }
    compact = {"separators": (",", ":")}
    return {
        name: (path, json.dumps(body, **compact).encode(), more) for name, (path, body, more) in asked.items()
    }


@contextmanager
def service(group: Path | None = None) -> Iterator[tuple[str, psutil.Process]]:
    """A service of its own, in this control group."""
    with tempfile.TemporaryDirectory() as folder:
        port = free_port()
        command = [sys.executable, "-m", "safestart", "serve", "--port", str(port)]
        if group is not None:
            command = ["sh", "-c", f'echo $$ > "$0" && exec {" ".join(command)}', str(group / "cgroup.procs")]
        url = f"sqlite:///{folder}/bench.sqlite3"
        database = Database(url)
        database.migrate()  # a service that does so itself has 13 MB more for the rest of its life
        database.close()
        environment = os.environ | {"SAFESTART_DATABASE_URL": url}
        address = f"http://127.0.0.1:{port}"
        with own_group(command, env=environment, stdout=subprocess.DEVNULL) as process:
            while True:
                with suppress(httpx.TransportError):
                    httpx.get(f"{address}/healthz").raise_for_status()
                    break
                time.sleep(0.05)
            yield address, psutil.Process(process.pid)


def watched(address: str, process: psutil.Process, work: Callable[[], Any]) -> dict[str, Any]:
    """Peak memory, MB, and quantiles of health, s, while the work is done; and what it returned."""
    with watching(health, address) as times_of, watching(memory, process.pid) as peaks_of:
        begun = time.perf_counter()
        answers = work()
        took = time.perf_counter() - begun
        times, peaks = sorted(times_of()), peaks_of()
    return {
        "answers": answers,
        "took_s": round(took, 2),
        "peak_mb": round(peaks["Pss"] / 1e6),
        "own_mb": round(peaks["Pss_Anon"] / 1e6),
        "health_p99_s": round(times[min(len(times) - 1, int(0.99 * len(times)))], 4) if times else None,
        "health_asked": len(times),
    }


async def posted(address: str, asked: tuple[str, bytes, dict[str, str]], number: int) -> dict[int, int]:
    """Statuses of ``number`` equal requests at once, counted; each body is read to its end and dropped."""
    path, body, more = asked
    headers = {"Content-Type": "application/json", **more}

    async def one() -> int:
        async with (
            httpx.AsyncClient(base_url=address, timeout=_LONGEST_S) as client,
            client.stream("POST", path, content=body, headers=headers) as answer,
        ):
            async for _ in answer.aiter_raw():
                pass
            return answer.status_code

    found = await asyncio.gather(*(one() for _ in range(number)))
    return {status: found.count(status) for status in sorted(set(found))}


def _posted(address: str, asked: tuple[str, bytes, dict[str, str]], number: int) -> dict[int, int]:
    return asyncio.run(posted(address, asked, number))


def measure(
    report: Callable[[str, dict[str, Any]], None] = lambda _name, _found: None, group: Path | None = None
) -> dict[str, Any]:
    """Every operation alone, then sixteen of each at once; a fresh service for each of the two."""
    found: dict[str, Any] = {}
    for number in (1, TOGETHER):
        with service(group) as (address, process):
            asyncio.run(posted(address, operations()["100 000 wrong starts"], 2))  # helper processes load
            for name, asked in operations().items():
                key = f"{number} x {name}"
                found[key] = watched(address, process, partial(_posted, address, asked, number))
                report(key, found[key])
    return found


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("cgroup", nargs="?", type=Path)
    measure(lambda name, found: print(f"{name:40} {found}", flush=True), asked.parse_args().cgroup)
