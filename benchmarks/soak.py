"""Hours of jobs while processes are killed, by hand: ``python -m benchmarks.soak DATABASE_URL [--minutes 480]``.

Jobs are submitted at ``--rate`` a second. Every ``--kill-every`` seconds a random process (service, worker, one of its
task processes) gets SIGKILL, and whoever supervises it starts it again. At the end each accepted job must be there once
and successful. ``--log FILE`` keeps a line a minute: jobs, kills, and memory of all processes, without what is shared.
The database must be new: an SQLite file that is not there, or an empty PostgreSQL database.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import tempfile
import threading
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path
from statistics import median
from typing import Any

import psutil

from tests.chaos.platform import KINDS, Platform

TINY = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 3, "ny": 3, "y_max_m": 150}}
DRAIN_S = 900.0
LIMITS = {
    "SAFESTART_MAX_QUEUED": "100000",
    "SAFESTART_RATE_PER_S": "1000000",
    "SAFESTART_SUBMIT_RATE_PER_S": "1000000",
}


def soak(
    url: str, log: Path, *, minutes: float, rate: float, kill_every_s: float, seed: int
) -> dict[str, Any]:
    """Submit, kill, wait for the end, count. Raises AssertionError when a service stays away."""
    platform = Platform(url, log.parent, LIMITS)
    ended = threading.Event()
    kills: Counter[str] = Counter()
    memory: list[float] = []
    killer = threading.Thread(target=_kill, args=(platform, ended, kills, kill_every_s, random.Random(seed)))
    watcher = threading.Thread(target=_watch, args=(platform, ended, memory))
    ids: list[str] = []
    try:
        begun = last = time.monotonic()
        killer.start(), watcher.start()
        while (now := time.monotonic()) < begun + 60 * minutes:
            due = begun + len(ids) / rate
            if now < due:
                time.sleep(min(due - now, 1.0))
                continue
            ids.append(
                platform.submit(
                    "certificate", TINY | {"omega_t_deg_s": 1 + len(ids) % 500 / 100}, f"k{len(ids)}"
                )
            )
            if now > last + 60.0:
                last = now
                _note(
                    log, {"minute": round((now - begun) / 60), "jobs": len(ids), "kills": dict(kills)}, memory
                )
        ended.set()
        killer.join(), watcher.join()
        statuses = _drained(platform)
        took_s = time.monotonic() - begun
        doubled = sum(
            platform.events(job).count('"status":"successful"') != 1
            for job in ids[:: max(1, len(ids) // 200)]
        )
    finally:
        ended.set()
        platform.close()
    tenth = max(1, len(memory) // 10)
    return {
        "database": url.partition(":")[0],
        "minutes": round(took_s / 60, 1),
        "submitted": len(ids),
        "kills": dict(kills),
        "lost": len(set(ids) - set(statuses)),
        "doubled": len(statuses) - len(set(ids)) + len(ids) - len(set(ids)) + doubled,
        "statuses": dict(Counter(statuses.values())),
        # The first tenth warms up.
        "memory_growth": round(median(memory[-tenth:]) / median(memory[tenth : 2 * tenth]) - 1, 4)
        if memory[2:]
        else None,
    }


def _kill(
    platform: Platform, ended: threading.Event, kills: Counter[str], every_s: float, draw: random.Random
) -> None:
    while not ended.wait(every_s):
        kind = draw.choice(KINDS)
        with suppress(psutil.Error):
            platform.kill(kind)
            kills[kind] += 1


def _watch(platform: Platform, ended: threading.Event, memory: list[float]) -> None:
    """Memory of all processes, MB, every 5 s, when all are there: a killed one weighs nothing until it is back."""
    while not ended.wait(5.0):
        with suppress(psutil.Error):
            processes = [one for kind in KINDS for one in platform.processes(kind)]
            if len(processes) == 2 * 2 + 1:
                memory.append(sum(one.memory_full_info().uss for one in processes) / 1e6)


def _drained(platform: Platform) -> dict[str, str]:
    """Status of every job by id, once none is open."""
    deadline = time.monotonic() + DRAIN_S
    while True:
        found: dict[str, str] = {}
        path = "/jobs?limit=200"
        while path:
            page = platform.get(path)
            found |= {job["jobID"]: job["status"] for job in page["jobs"]}
            path = next((link["href"] for link in page["links"] if link["rel"] == "next"), "")
        if not set(found.values()) & {"accepted", "running"} or time.monotonic() > deadline:
            return found
        time.sleep(5.0)


def _note(log: Path, line: dict[str, Any], memory: list[float]) -> None:
    with log.open("a") as sink:
        sink.write(json.dumps(line | {"memory_mb": round(memory[-1]) if memory else None}) + "\n")


def main(arguments: list[str]) -> int:
    """Exit code 0 when nothing is lost, nothing doubled, and all are successful."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("database_url")
    parser.add_argument("--minutes", type=float, default=480.0)
    parser.add_argument("--rate", type=float, default=5.0)
    parser.add_argument("--kill-every", type=float, default=30.0)
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--log", type=Path)
    given = parser.parse_args(arguments)
    log = given.log or Path(tempfile.mkdtemp(prefix="soak-")) / "soak.jsonl"
    found = soak(
        given.database_url,
        log,
        minutes=given.minutes,
        rate=given.rate,
        kill_every_s=given.kill_every,
        seed=given.seed,
    )
    print(json.dumps(found | {"log": str(log)}, indent=2))
    whole = found["statuses"] == {"successful": found["submitted"]}
    return 0 if whole and not found["lost"] and not found["doubled"] else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
