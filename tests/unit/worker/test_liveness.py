"""Which silence means that a job is lost. The cluster is scripted: a deaf client cannot be provoked."""

from __future__ import annotations

import asyncio
from typing import Any, cast

import pytest

from safestart_worker.cluster.cluster import Cluster, Where
from safestart_worker.jobs import liveness as signs
from safestart_worker.jobs.liveness import LEAST_SHARE, Finding, Signs

PATIENCE_S = 60.0
RUNNING = Where(frozenset({"tcp://a"}), over=False)
OVER = Where(frozenset(), over=True)
WAITING = Where(frozenset(), over=False)
TASK: list[Any] = [object()]


class Scripted:
    """Reports whatever a test sets."""

    def __init__(self) -> None:
        self.now, self.used, self.here, self.all_there = 0.0, 0.0, RUNNING, True
        self.local, self.crowd = True, 1.0

    async def where(self, futures: list[Any]) -> Where:
        assert futures
        return self.here

    def cpu_s(self, addresses: frozenset[str]) -> float | None:
        return self.used if self.local else None

    def share(self) -> float:
        return self.crowd

    async def complete(self) -> bool:
        return self.all_there


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> Scripted:
    found = Scripted()
    monkeypatch.setattr(signs.time, "monotonic", lambda: found.now)
    return found


def findings(
    script: Scripted, seconds: int, busy: float = 0.0, *, hears: bool = False, futures: list[Any] = TASK
) -> set[Finding]:
    """What looks every ten seconds say, over a stretch of time with ``busy`` of a core in use."""
    watch = Signs(cast(Cluster, script), PATIENCE_S)
    assert watch.period_s == 10.0
    said = set()
    for _ in range(seconds // 10):
        said.add(asyncio.run(watch.look(futures)))
        script.now += 10.0
        script.used += 10.0 * busy
        if hears:
            watch.heard()
    return said


def test_a_silent_computation_is_left_alone(script: Scripted) -> None:
    assert findings(script, 3600, 0.5) == {Finding.ALIVE}
    assert findings(script, 3600, 1.2 * LEAST_SHARE) == {Finding.ALIVE}


def test_a_process_that_does_nothing_is_found_after_the_patience(script: Scripted) -> None:
    assert findings(script, 60, 0.01) == {Finding.ALIVE}
    assert findings(script, 80, 0.01) == {Finding.ALIVE, Finding.HUNG}
    assert findings(script, 3600, 0.01, hears=True) == {Finding.ALIVE}


def test_on_a_crowded_machine_a_computation_that_gets_little_is_left_alone(script: Scripted) -> None:
    """Seen: two cores for thirty processes, and three jobs in a row "lost" although they computed."""
    script.crowd = 2 / 30
    assert findings(script, 3600, 0.02) == {Finding.ALIVE}
    assert Finding.HUNG in findings(script, 80, 0.0)


def test_the_end_that_was_not_heard_of_is_found(script: Scripted) -> None:
    script.here = OVER
    assert Finding.DEAF not in findings(script, 60)
    assert Finding.DEAF in findings(script, 80)


def test_waiting_for_a_process_is_a_loss_only_where_one_is_missing(script: Scripted) -> None:
    script.here = WAITING
    assert findings(script, 3600) == {Finding.ALIVE}
    script.all_there = False
    assert Finding.HOMELESS in findings(script, 80)


def test_elsewhere_only_the_scheduler_knows_of_processes(script: Scripted) -> None:
    script.local = False
    assert findings(script, 3600) == {Finding.ALIVE}
    script.here = OVER
    assert Finding.DEAF in findings(script, 80)


def test_a_job_that_waits_for_the_database_is_not_silent(script: Scripted) -> None:
    script.here = OVER
    assert findings(script, 3600, futures=[]) == {Finding.ALIVE}
