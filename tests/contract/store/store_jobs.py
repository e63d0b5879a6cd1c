"""Jobs as the tests of the store need them."""

from __future__ import annotations

from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.records import Claim, Job
from tests.contract.store.store_backends import pass_time

LEASE_S = 30.0


def submit(jobs: JobRepository, process_id: str = "certificate", **more) -> Job:
    return jobs.submit(process_id, more.pop("inputs", {"a": 1}), timeout_s=60.0, **more)


def claimed(jobs: JobRepository, lease_s: float = LEASE_S, **more) -> Claim:
    claim = jobs.claim("worker", lease_s, **more)
    assert claim is not None
    return claim


def lapse(database: Database) -> None:
    """The time of a lease passes."""
    pass_time(database, LEASE_S + 1.0)
