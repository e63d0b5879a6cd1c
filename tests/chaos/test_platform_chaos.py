"""The whole platform with everything real: service, two workers, their Dask processes; any of them is killed.

The short form kills one of each kind; the long one (``pytest -m chaos_long tests/chaos``) ten, on each database;
``python -m benchmarks.soak`` goes on for hours.
"""

from __future__ import annotations

import time
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from safestart.processes.execute import execute
from safestart.records.comparable import comparable
from tests.chaos.platform import KINDS, Platform
from tests.contract.store.store_backends import BACKENDS, POSTGRESQL, fresh_url
from tests.waiting import until

JOBS = 30


def inputs(number: int) -> dict[str, Any]:
    grid = {"nx": 150, "ny": 150, "y_max_m": 150}
    rates = [1 + 0.01 * number + 0.5 * i for i in range(8)]
    return {"omega_t_deg_s": rates, "a_max_m_s2": [0.05, 0.1], "grid": grid}


def submit(platform: Platform, number: int) -> str:
    """Queue a job of a few tenths of a second."""
    return platform.submit("coverage", inputs(number), f"k{number}")


def counts(platform: Platform) -> Counter[str]:
    jobs = platform.get("/jobs?limit=200")["jobs"]
    assert len(jobs) == JOBS
    return Counter(job["status"] for job in jobs)


def hammer(url: str, folder: Path, kills: int) -> None:
    platform = Platform(url, folder)
    try:
        ids = [submit(platform, number) for number in range(JOBS // 2)]
        for kill in range(kills):
            time.sleep(1.0)
            platform.kill(KINDS[kill % len(KINDS)])
            if kill == kills // 2:
                ids += [submit(platform, number) for number in range(JOBS // 2, JOBS)]
        until(lambda: counts(platform) == {"successful": JOBS}, "success of all", log=platform.log)
        assert len(set(ids)) == JOBS
        for number, job in enumerate(ids):
            document = platform.get(f"/jobs/{job}/results")
            if number % 10 == 0:
                expected = execute("coverage", inputs(number)).document
                assert comparable(document["outputs"]) == comparable(expected["outputs"])
        assert platform.events(ids[0]).count('"status":"successful"') == 1
    finally:
        platform.close()


@pytest.fixture
def short_url(tmp_path: Path) -> str:
    return fresh_url("postgresql" if POSTGRESQL else "sqlite", tmp_path)


def test_one_process_of_each_kind_is_killed(short_url: str, tmp_path: Path) -> None:
    hammer(short_url, tmp_path, len(KINDS))


@pytest.mark.chaos_long
@pytest.mark.parametrize("backend", BACKENDS)
def test_ten_processes_are_killed(backend: str, tmp_path: Path) -> None:
    hammer(fresh_url(backend, tmp_path), tmp_path, 10)
