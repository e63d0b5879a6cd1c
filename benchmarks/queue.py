"""The platform under load, by hand: ``python -m benchmarks.queue [--database-url URL] [--only NAME] [--jobs N]``.

Where others use the machine, ``chrt -f 1 python -m benchmarks.queue ...`` (root) measures as if they did not.

pickup    median time from the 201 to ``running`` (target 0.3 s)
tiny      jobs per second of one worker on jobs that compute nearly nothing (target 50)
list      95th percentile of GET /jobs with 10 000 waiting jobs (target 50 ms)
clients   200 clients on GET /go-no-go for 60 s, 1 000 requests per second in all: errors (0: one ends the run), 99th
          percentile over the unloaded median (target 10); beside a bare FastAPI endpoint
crowd     the same, each client asking again as soon as it has its answer: the last in line waits for all the others, so
          that 200 is the least ratio that one process can have
memory    growth of the worker's and the service's memory over --jobs tiny jobs (target 5 % over 20 000)
"""

from __future__ import annotations

import argparse
import json
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from statistics import median, quantiles
from typing import Any

import httpx
import psutil

from benchmarks.own_group import own_group

QUESTION = "/go-no-go?omega_t_deg_s=3&a_max_m_s2=0.1&x_m=5&y_m=40"
TINY = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 3, "ny": 3, "y_max_m": 150}}
READY_S = 300.0


@contextmanager
def platform(url: str, *, worker: bool = True) -> Iterator[tuple[httpx.Client, list[psutil.Process]]]:
    """``safestart up`` (or the service alone) on a free port: a client, and its processes."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    environment = os.environ | {"SAFESTART_DATABASE_URL": url, "SAFESTART_MAX_QUEUED": "100000"}
    environment |= {"SAFESTART_RATE_PER_S": "1000000", "SAFESTART_SUBMIT_RATE_PER_S": "1000000"}
    command = [sys.executable, "-m", "safestart", "up" if worker else "serve", "--port", str(port)]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with own_group(command, env=environment, **quiet) as process:
        # The service closes connections that are idle for 5 s; on a slow machine this could hit a request.
        brief = httpx.Limits(keepalive_expiry=1.0)
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60.0, limits=brief) as client:
            deadline = time.monotonic() + READY_S
            while not _answers(client, "/readyz" if worker else "/healthz"):
                if time.monotonic() > deadline:
                    raise RuntimeError("not ready")
                time.sleep(0.1)
            family = psutil.Process(process.pid)
            yield client, [family, *family.children(recursive=True)]


def _answers(client: httpx.Client, path: str) -> bool:
    try:
        return client.get(path).is_success
    except httpx.TransportError:
        return False


def submit(client: httpx.Client) -> str:
    """Queue a tiny job."""
    headers = {"Prefer": "respond-async"}
    answer = client.post("/processes/certificate/execution", json={"inputs": TINY}, headers=headers)
    answer.raise_for_status()
    job: str = answer.json()["jobID"]
    return job


def pickup(url: str, repeats: int = 40) -> dict[str, float]:
    """Seconds between the answer to a submission and its start, one job at a time, on the database's clock."""
    taken = []
    with platform(url) as (client, _):
        for _ in range(repeats):
            job = submit(client)
            while client.get(f"/jobs/{job}").json()["status"] in ("accepted", "running"):
                time.sleep(0.05)
            found = client.get(f"/jobs/{job}").json()
            created, started = (_seconds(found[name]) for name in ("created", "started"))
            taken.append(started - created)
            time.sleep(0.05 + 0.2 * (len(taken) % 7) / 7)  # no beat with the worker's poll
    return {"median_s": median(taken), "largest_s": max(taken)}


def _seconds(text: str) -> float:
    from datetime import datetime

    return datetime.fromisoformat(text).timestamp()


def tiny(url: str, jobs: int = 400) -> dict[str, Any]:
    """Jobs per second of one worker, over the second half of jobs that all wait already.

    ``cpu_s_per_job``, of each process that works, does not depend on what else the machine does.
    """
    with platform(url) as (client, family):
        with ThreadPoolExecutor(4) as pool:
            ids = list(pool.map(lambda _: submit(client), range(jobs)))
        halfway = ids[jobs // 2]
        while client.get(f"/jobs/{halfway}").json()["status"] != "successful":
            time.sleep(0.2)
        before = _cpu(family)
        left = client.get("/readyz").json()["jobs"]["accepted"]
        while client.get(f"/jobs/{ids[-1]}").json()["status"] != "successful":
            time.sleep(0.5)
        after = _cpu(family)
        time.sleep(0.5)
        found = [client.get(f"/jobs/{job}").json() for job in ids[jobs // 2 :]]
        ends = sorted(_seconds(job["finished"]) for job in found)
    spent = {name: round((after[name] - before[name]) / max(left, 1), 5) for name in after if name in before}
    return {"jobs_per_s": (len(ends) - 1) / (ends[-1] - ends[0]), "cpu_s_per_job": spent}


def _cpu(family: list[psutil.Process]) -> dict[str, float]:
    """Processor seconds of the processes, by kind."""
    found = {}
    for process in family:
        command = process.cmdline()
        times = process.cpu_times()
        what = (
            "task"
            if any("spawn_main" in part for part in command)
            else command[3]
            if len(command) > 3
            else "?"
        )
        found[f"{what} {process.pid}"] = times.user + times.system
    return found


def list_page(url: str, waiting: int = 10_000, repeats: int = 200) -> dict[str, float]:
    """Time of GET /jobs while many jobs wait."""
    with platform(url, worker=False) as (client, _):
        with ThreadPoolExecutor(8) as pool:
            list(pool.map(lambda _: submit(client), range(waiting)))
        taken = []
        for _ in range(repeats):
            start = time.perf_counter()
            client.get("/jobs").raise_for_status()
            taken.append(time.perf_counter() - start)
    return {"median_s": median(taken), "p95_s": quantiles(taken, n=20)[-1]}


def clients(url: str, per_s: float = 1000.0, number: int = 200, seconds: float = 60.0) -> dict[str, Any]:
    """Many clients, ``per_s`` requests per second in all (0: each asks as soon as it can), beside a bare endpoint."""
    from benchmarks.server import server

    document = json.dumps({"verdict": "GO"})
    with (
        platform(url, worker=False) as (client, _),
        server("benchmarks.peers.constant_service:app", "/encoded", CONSTANT_DOCUMENT=document) as bare,
    ):
        ours = client.base_url.port
        assert ours is not None
        return {
            "service": _crowd(ours, QUESTION, number, seconds, per_s),
            "bare": _crowd(bare, "/constant", number, seconds, per_s),
        }


def _crowd(port: int, path: str, number: int, seconds: float, per_s: float) -> dict[str, float]:
    from benchmarks.load import latencies

    alone = median(latencies(port, [path], 2.0, 1))
    taken = latencies(port, [path], seconds, number, per_s)
    parts = quantiles(taken, n=100)
    return {
        "answers": len(taken),
        "per_s": per_s,
        "unloaded_median_s": alone,
        "median_s": parts[49],
        "p99_s": parts[98],
        "ratio": parts[98] / alone,
        "load": os.getloadavg()[0],
    }


def memory(url: str, jobs: int) -> dict[str, Any]:
    """Unique memory of each process after a tenth of the jobs, and at the end."""
    with platform(url) as (client, family):
        done = threading.Event()

        def feed(_: int) -> None:
            for _ in range(jobs // 4):
                submit(client)

        with ThreadPoolExecutor(4) as pool:
            fed = [pool.submit(feed, i) for i in range(4)]
            first: dict[int, int] = {}
            while not done.is_set():
                counts = client.get("/readyz").json().get("jobs", {})
                successful = counts.get("successful", 0)
                if not first and successful >= jobs // 10:
                    first = _used(family)
                if successful >= 4 * (jobs // 4):
                    done.set()
                for item in fed:
                    if item.done():
                        item.result()  # raises the task's error; otherwise the rest would wait in vain
                time.sleep(0.5)
        last = _used(family)
    grown = {pid: last[pid] / first[pid] - 1.0 for pid in first if pid in last}
    return {
        "jobs": jobs,
        "start_mib": round(sum(first.values()) / 2**20, 1),
        "end_mib": round(sum(last[pid] for pid in grown) / 2**20, 1),
        "growth": sum(last[pid] for pid in grown) / sum(first[pid] for pid in grown) - 1.0,
    }


def _used(family: list[psutil.Process]) -> dict[int, int]:
    found = {}
    for process in family:
        try:
            found[process.pid] = process.memory_full_info().uss
        except psutil.NoSuchProcess:
            continue
    return found


def main() -> None:
    """Run them and print the measurements."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--database-url", default="")
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=20_000)
    chosen = parser.parse_args()
    measured: dict[str, Any] = {}
    runs = {
        "pickup": pickup,
        "tiny": tiny,
        "list": list_page,
        "clients": clients,
        "crowd": lambda url: clients(url, per_s=0.0),
        "memory": lambda url: memory(url, chosen.jobs),
    }
    for name, run in runs.items():
        if chosen.only in ("", name):
            with tempfile.TemporaryDirectory() as folder:
                url = chosen.database_url or f"sqlite:///{Path(folder) / 'queue.sqlite3'}"
                measured[name] = run(url)
                print(json.dumps({name: measured[name], "load": os.getloadavg()[0]}), flush=True)


if __name__ == "__main__":
    main()
