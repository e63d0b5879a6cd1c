"""Shards of a job and the code that computed them, on a fake cluster: which are kept and which are repeated."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest

from safestart.processes.sharding import Part, content
from safestart.records.provenance import source
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.records import Claim
from safestart_worker.cluster.task import JobEnd, ShardEnd, run_shard
from safestart_worker.jobs.shards import Sharded
from safestart_worker.jobs.work import Journal
from tests.unit.processes.test_sharding import SHARDING, SPEC

COUNT = 4


class Done:
    """A task that has ended."""

    def __init__(self, outcome: Any) -> None:
        self._outcome = outcome

    async def result(self) -> Any:
        return self._outcome

    def release(self) -> None: ...


class Cluster:
    """Ends every task at once; its processes have the source ``by`` and merge as ``merged_by``."""

    def __init__(self, by: str, merged_by: str) -> None:
        self.by, self.merged_by = by, merged_by
        self.ran: list[int] = []

    async def threads(self) -> int:
        return 1

    def submit(self, function: Any, *arguments: Any, **_: Any) -> Done:
        if function is run_shard:
            _, part, number = arguments
            self.ran.append(number)
            return Done(ShardEnd(Part({"square": part["n"] ** 2}), self.by))
        documents = [part.document for part in arguments[2]]
        document = SHARDING.so_far(SPEC.parse({"count": COUNT}), documents)
        return Done(JobEnd(document, (), {"source_sha256": self.merged_by}))


@pytest.fixture
def jobs(tmp_path: Path) -> JobRepository:
    database = Database(f"sqlite:///{tmp_path / 'jobs.sqlite3'}")
    database.migrate()
    return JobRepository(database)


@pytest.fixture
def claim(jobs: JobRepository) -> Claim:
    jobs.submit("squares", {"count": COUNT}, timeout_s=60.0)
    claim = jobs.claim("worker", 60.0)
    assert claim is not None
    return claim


def run(jobs: JobRepository, claim: Claim, cluster: Cluster) -> JobEnd:
    sharded = Sharded(claim, "key", cluster, Journal(claim.job_id), jobs, SPEC, 3)  # type: ignore[arg-type]
    return asyncio.run(sharded.run())


def keep(jobs: JobRepository, claim: Claim, by: str) -> None:
    """Shards 0 and 1 are in the store, with a wrong result that tells whether they were used."""
    for number in (0, 1):
        jobs.save_shards(claim, [(number, content("squares", {"n": number}, by), {"square": 1000}, b"")])


def test_shards_of_the_same_code_are_not_done_again(jobs: JobRepository, claim: Claim) -> None:
    keep(jobs, claim, source())
    cluster = Cluster(source(), source())
    assert run(jobs, claim, cluster).document == {"total": 2000 + 4 + 9}
    assert cluster.ran == [2, 3]


def test_shards_of_other_code_are_done_again(jobs: JobRepository, claim: Claim) -> None:
    keep(jobs, claim, "other code")
    cluster = Cluster(source(), source())
    assert run(jobs, claim, cluster).document == {"total": 0 + 1 + 4 + 9}
    assert cluster.ran == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("by", "merged_by"), [("other code", source()), (source(), "other code")], ids=["shard", "merge"]
)
def test_a_job_is_not_put_together_from_different_code(
    jobs: JobRepository, claim: Claim, by: str, merged_by: str
) -> None:
    end = run(jobs, claim, Cluster(by, merged_by))
    assert end.document is None
    assert end.problem is not None
    assert end.problem["type"] == "urn:safestart:problem:other-source"
    assert source()[:12] in end.problem["detail"]
    assert "other code" in end.problem["detail"]
    if by != source():
        assert jobs.shard_contents(claim.job_id) == {}
