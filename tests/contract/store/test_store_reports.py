"""The store, on every backend: events, workers, shards."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safestart.errors import (
    LeaseLost,
)
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.records import Crew, JobStatus
from tests.contract.store.store_backends import pass_time
from tests.contract.store.store_jobs import claimed, lapse, submit
from tests.waiting import PATIENCE_S


def test_events_tell_the_story_in_order_and_are_read_in_parts(jobs: JobRepository) -> None:
    job, other = submit(jobs), submit(jobs)
    claim = claimed(jobs)
    jobs.progress(claim, 40.0, "sampling", 3.5)
    jobs.log(claim, "hello")
    jobs.succeed(claim, {}, (), {})
    events = jobs.events(job.id)
    assert [(event.kind, event.data) for event in events] == [
        ("status", {"status": "accepted"}),
        ("status", {"status": "running", "attempt": 1}),
        ("progress", {"progress": 40.0, "message": "sampling", "eta_s": 3.5}),
        ("log", {"message": "hello"}),
        ("status", {"status": "successful"}),
    ]
    assert [event.id for event in events] == sorted(event.id for event in events)
    assert all(event.at.tzinfo is not None for event in events)
    assert jobs.events(job.id, after_id=events[2].id) == events[3:]
    assert jobs.events(job.id, limit=2) == events[:2]
    assert [event.data for event in jobs.events(other.id)] == [{"status": "accepted"}]


def test_progress_is_in_the_row(jobs: JobRepository) -> None:
    job = submit(jobs)
    jobs.progress(claimed(jobs), 40.0, "sampling", 3.5)
    now = jobs.get(job.id)
    assert (now.progress, now.message, now.eta_s) == (40.0, "sampling", 3.5)


def test_workers_count_while_they_beat(database: Database, jobs: JobRepository) -> None:
    assert jobs.crew().workers == 0
    jobs.heartbeat("one", 2, 0)
    jobs.heartbeat("one", 2, 1)
    jobs.heartbeat("two", 4, 0)
    assert jobs.crew().workers == 2
    pass_time(database, PATIENCE_S)
    jobs.heartbeat("two", 4, 0)
    assert jobs.crew(within_s=PATIENCE_S).workers == 1
    assert jobs.crew(within_s=2 * PATIENCE_S) == Crew(2, 6, 1)
    jobs.farewell("two")
    assert jobs.owners_alive(within_s=2 * PATIENCE_S) == ("one",)
    assert jobs.crew() == Crew(0, 0, 0)


def test_workers_silent_for_a_day_are_forgotten_and_no_others(
    database: Database, jobs: JobRepository
) -> None:
    jobs.heartbeat("gone", 1, 0)
    pass_time(database, 50_000.0)
    jobs.heartbeat("silent", 1, 0)
    pass_time(database, 50_000.0)
    jobs.heartbeat("new", 1, 0)
    assert sorted(jobs.owners_alive(within_s=1e7)) == ["new", "silent"]


def test_finished_shards_are_kept_in_order_and_go_with_the_success(jobs: JobRepository) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    jobs.save_shards(claim, [(2, "c2", {"n": 2}, b"two")])
    jobs.save_shards(
        claim, [(0, "c0", {"n": 0}, b""), (2, "c2", {"n": 22}, b"again"), (1, "c1", {"n": 1}, b"")]
    )
    assert jobs.shard_contents(job.id) == {0: "c0", 1: "c1", 2: "c2"}
    assert jobs.shard_documents(job.id) == ({"n": 0}, {"n": 1}, {"n": 22})
    kept = [(shard.number, shard.data) for shard in jobs.shards(job.id)]
    assert kept == [(0, b""), (1, b""), (2, b"again")]
    jobs.succeed(claim, {"outputs": {}}, (), {})
    assert jobs.shards(job.id) == ()


def test_a_shard_replaces_its_own_job_s_alone(jobs: JobRepository) -> None:
    one, two = submit(jobs), submit(jobs)
    claims = [claimed(jobs), claimed(jobs)]
    for claim in (*claims, claims[1]):
        jobs.save_shards(claim, [(0, "c", {"of": claim.job_id}, b"")])
    assert jobs.shard_documents(one.id) == ({"of": one.id},)
    assert jobs.shard_documents(two.id) == ({"of": two.id},)
    jobs.succeed(claims[1], {}, (), {})
    assert jobs.shard_documents(one.id) == ({"of": one.id},)


def test_a_worker_that_lost_its_lease_adds_no_shard(database: Database, jobs: JobRepository) -> None:
    job = submit(jobs)
    late = claimed(jobs)
    jobs.save_shards(late, [(0, "c", {}, b"")])
    lapse(database)
    claimed(jobs)
    with pytest.raises(LeaseLost):
        jobs.save_shards(late, [(1, "c", {}, b"")])
    assert jobs.shard_contents(job.id) == {0: "c"}, "what was finished in time is there for the next worker"


def test_attempts_count_from_the_last_finished_shard(database: Database, jobs: JobRepository) -> None:
    job = submit(jobs)
    for _ in range(2):
        claim = claimed(jobs, max_attempts=2)
        lapse(database)
    claim = replace(claim)
    with pytest.raises(LeaseLost):
        jobs.save_shards(replace(claim, token=claim.token - 1), [(0, "c", {}, b"")])
    jobs.save_shards(claim, [(0, "c", {}, b"")])
    assert claimed(jobs, max_attempts=2).attempt == 2
    assert jobs.get(job.id).status is JobStatus.RUNNING


def test_shards_of_a_job_that_failed_stay(jobs: JobRepository) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    jobs.save_shards(claim, [(0, "c", {"n": 1}, b"")])
    jobs.fail(claim, {"detail": "no"})
    assert jobs.shard_documents(job.id) == ({"n": 1},)
