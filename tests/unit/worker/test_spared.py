"""Tasks that Dask gives up: killers end, those that only waited beside one are submitted again."""

from __future__ import annotations

import asyncio
from typing import Any, cast

import pytest
from distributed import KilledWorker

from safestart.store.records import Claim
from safestart_worker.cluster.cluster import Cluster
from safestart_worker.jobs.work import Journal, Whole

MOST = 3
CLAIM = Claim("job", "worker", 1, "certificate", {}, 1, 60.0)


class Fate:
    """A task that reports so many starts and is then given up, or ends."""

    def __init__(self, starts: int, outcome: str) -> None:
        self.starts, self.outcome = starts, outcome
        self.on_start: Any = None

    async def result(self) -> str:
        for _ in range(self.starts):
            self.on_start({"kind": "started", "pid": 1, "address": "tls://here"})
        if not self.outcome:
            raise KilledWorker("task", None, MOST - 1)
        return self.outcome


class Fates:
    """A cluster on which the submissions of a job have these fates, one after the other."""

    def __init__(self, *fates: Fate) -> None:
        self.fates = list(fates)
        self.keys: list[str] = []

    def submit(self, *_: Any, key: str, job: str) -> Fate:
        assert job == "key", "reports and requests to stop go by the job"
        self.keys.append(key)
        return self.fates.pop(0)


def run(*fates: Fate) -> tuple[Any, list[str]]:
    cluster = Fates(*fates)
    whole = Whole(CLAIM, "key", cast(Cluster, cluster), Journal("job"), MOST)
    for fate in fates:
        fate.on_start = whole.on_report
    try:
        return asyncio.run(whole.run()), cluster.keys
    except KilledWorker:
        return None, cluster.keys


@pytest.mark.parametrize("starts", [0, 1, 2])
def test_who_waited_beside_a_killer_is_submitted_again(starts: int) -> None:
    found, keys = run(Fate(starts, ""), Fate(1, "done"))
    assert found == "done"
    assert len(set(keys)) == 2, "Dask knows a key that it has given up"


def test_who_has_died_as_often_as_is_allowed_is_not() -> None:
    assert run(Fate(MOST, ""), Fate(1, "done")) == (None, ["key"])
    found, keys = run(Fate(1, ""), Fate(2, ""), Fate(1, "done"))
    assert found is None
    assert len(keys) == 2


def test_who_dies_before_it_reports_a_start_has_an_end() -> None:
    found, keys = run(*[Fate(0, "")] * MOST, Fate(1, "done"))
    assert found is None
    assert len(keys) == MOST
