"""The store, on every backend: claims, leases, lost workers and dead task processes."""

from __future__ import annotations

import multiprocessing
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from sqlalchemy import create_engine, make_url, text

from safestart.errors import (
    LeaseLost,
)
from safestart.records.artifact import Artifact
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.results import ResultRepository
from safestart.store.records import Claim, JobStatus
from tests.contract.store.store_backends import BACKENDS, pass_time
from tests.contract.store.store_jobs import LEASE_S, claimed, lapse, submit
from tests.waiting import until


def test_an_empty_queue_has_no_claim(jobs: JobRepository) -> None:
    assert jobs.claim("worker", LEASE_S) is None


def test_a_claim_makes_the_job_run_under_a_lease(jobs: JobRepository) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    now = jobs.get(job.id)
    assert claim == Claim(job.id, "worker", 1, "certificate", {"a": 1}, 1, 60.0)
    assert (now.status, now.owner, now.attempts) == (JobStatus.RUNNING, "worker", 1)
    assert now.started_at is not None
    assert now.lease_expires_at is not None
    assert abs((now.lease_expires_at - now.started_at).total_seconds() - LEASE_S) < 0.5
    assert jobs.claim("other", LEASE_S) is None


def test_renewing_keeps_the_lease(database: Database, jobs: JobRepository) -> None:
    submit(jobs)
    claim = claimed(jobs)
    for _ in range(4):
        pass_time(database, LEASE_S / 2)
        assert jobs.renew(claim, LEASE_S) is True
        assert jobs.claim("other", LEASE_S) is None


def test_a_longer_lease_is_not_taken_for_a_clock_set_back(jobs: JobRepository) -> None:
    """A lease is stored with its own length, and a renewal may change it."""
    submit(jobs)
    claim = claimed(jobs, LEASE_S)
    assert jobs.renew(claim, 5 * LEASE_S) is True
    assert jobs.claim("other", LEASE_S) is None


def told(jobs: JobRepository, job_id: str) -> list[str]:
    return [event.data["message"] for event in jobs.events(job_id) if event.kind == "log"]


def test_an_expired_lease_is_taken_over_and_the_late_writer_is_refused(
    jobs: JobRepository, results: ResultRepository
) -> None:
    job = submit(jobs)
    late = claimed(jobs, 0.3)
    new = until(lambda: jobs.claim("other", LEASE_S), "the end of a lease")
    assert (new.job_id, new.token, new.attempt) == (job.id, late.token + 1, 2)
    before = (jobs.get(job.id), jobs.events(job.id))
    writes = (
        lambda: jobs.renew(late, LEASE_S),
        lambda: jobs.progress(late, 50.0, "late", None),
        lambda: jobs.log(late, "late"),
        lambda: jobs.succeed(late, {"late": True}, (Artifact("a", "text/plain", b"late"),), {}),
        lambda: jobs.fail(late, {"detail": "late"}),
        lambda: jobs.dismissed(late),
        lambda: jobs.release(late, "late"),
    )
    for write in writes:
        with pytest.raises(LeaseLost, match="no longer held by worker"):
            write()
    assert (jobs.get(job.id), jobs.events(job.id)) == before
    jobs.succeed(new, {"ok": True}, (), {})
    assert results.result(job.id).document == {"ok": True}
    assert results.artifacts(job.id) == ()


def test_a_late_owner_whose_job_nobody_took_may_go_on(database: Database, jobs: JobRepository) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    lapse(database)
    assert jobs.renew(claim, LEASE_S) is True
    jobs.succeed(claim, {}, (), {})
    assert jobs.get(job.id).status is JobStatus.SUCCESSFUL


@pytest.mark.parametrize("jump_s", [-86_400, -90, 86_400])
def test_no_job_is_stuck_when_the_clock_of_the_database_was_set(
    database: Database, jobs: JobRepository, jump_s: float
) -> None:
    job = submit(jobs)
    late = claimed(jobs)
    assert jobs.claim("other", LEASE_S) is None
    pass_time(database, jump_s)
    assert jobs.renew(late, LEASE_S)  # its worker lives and renews: nothing is taken from it
    assert jobs.claim("other", LEASE_S) is None
    pass_time(database, jump_s)  # its worker is lost
    new = jobs.claim("other", LEASE_S)
    assert new is not None
    with pytest.raises(LeaseLost):
        jobs.succeed(late, {}, (), {})
    jobs.succeed(new, {}, (), {})
    assert jobs.get(job.id).status is JobStatus.SUCCESSFUL


def test_a_small_step_of_the_clock_takes_no_job_from_its_worker(
    database: Database, jobs: JobRepository
) -> None:
    submit(jobs)
    claimed(jobs)
    for jump_s in (-LEASE_S / 2, LEASE_S / 2):
        pass_time(database, jump_s)
        assert jobs.claim("other", LEASE_S) is None
        pass_time(database, -jump_s)


def test_a_dead_task_process_costs_an_attempt(jobs: JobRepository) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    jobs.progress(claim, 50.0, "half", 1.0)
    assert jobs.restarted(claim, 3) is True
    now = jobs.get(job.id)
    assert (now.attempts, now.progress, now.message) == (2, 0.0, "starting, attempt 2")
    assert now.eta_s is None
    assert jobs.restarted(claim, 3) is True
    assert jobs.restarted(claim, 3) is False
    jobs.poisoned(claim, 3)
    ended = jobs.get(job.id)
    assert (ended.status, ended.attempts) == (JobStatus.FAILED, 3)
    assert ended.problem is not None
    assert "started 3 times" in ended.problem["detail"]
    assert "3 times its task process died" in ended.problem["detail"]
    assert "worker" not in ended.problem["detail"]
    assert jobs.tallies() == {"lease_losses": 0, "task_deaths": 3, "poisoned": 1}
    ends = ("starting, attempt 2", "starting, attempt 3", "no attempt is left")
    assert told(jobs, job.id) == [f"its task process died; {end}" for end in ends]


def test_a_job_that_lost_its_worker_and_its_task_processes_says_both(
    database: Database, jobs: JobRepository
) -> None:
    job = submit(jobs)
    claimed(jobs)
    lapse(database)
    claim = claimed(jobs)
    assert told(jobs, job.id) == ["worker worker was lost: its lease ran out; starting, attempt 2"]
    assert jobs.restarted(claim, 3) is True
    assert jobs.restarted(claim, 3) is False
    jobs.poisoned(claim, 3)
    problem = jobs.get(job.id).problem
    assert problem is not None
    assert "1 times its worker was lost and 2 times its task process died" in problem["detail"]


def test_the_same_owner_with_an_old_token_is_refused(jobs: JobRepository) -> None:
    submit(jobs)
    claim = claimed(jobs)
    with pytest.raises(LeaseLost):
        jobs.renew(replace(claim, token=claim.token - 1), LEASE_S)
    with pytest.raises(LeaseLost):
        jobs.renew(replace(claim, owner="thief"), LEASE_S)


def test_a_job_that_loses_every_worker_fails_as_poison(database: Database, jobs: JobRepository) -> None:
    poison, good = submit(jobs), submit(jobs)
    for _ in range(2):
        assert claimed(jobs, max_attempts=2).job_id == poison.id
        lapse(database)
    assert claimed(jobs, max_attempts=2).job_id == good.id
    ended = jobs.get(poison.id)
    assert ended.status is JobStatus.FAILED
    assert ended.problem is not None
    assert "started 2 times" in ended.problem["detail"]
    assert "2 times its worker was lost" in ended.problem["detail"]
    assert jobs.tallies() == {"lease_losses": 1, "task_deaths": 0, "poisoned": 1}
    said = [event.data.get("lost") for event in jobs.events(poison.id) if event.kind == "log"]
    assert said == ["worker"]
    assert jobs.events(poison.id)[-1].data == {"status": "failed", "message": ended.problem["detail"]}
    assert (ended.finished_at is not None, ended.owner, ended.lease_expires_at) == (True, None, None)


def test_a_released_job_waits_at_its_old_place_and_lost_no_attempt(jobs: JobRepository) -> None:
    first, second = submit(jobs), submit(jobs)
    claim = claimed(jobs)
    jobs.progress(claim, 50.0, "half", 1.0)
    jobs.release(claim, "the worker stops")
    job = jobs.get(first.id)
    assert (job.status, job.attempts, job.owner) == (JobStatus.ACCEPTED, 0, None)
    assert (job.progress, job.started_at, job.eta_s) == (0.0, None, None)
    assert jobs.events(first.id)[-1].data == {"status": "accepted", "message": "the worker stops"}
    assert job.message == "the worker stops"
    assert [jobs.position(item.id) for item in (first, second)] == [1, 2]
    with pytest.raises(LeaseLost):
        jobs.progress(claim, 1.0, "", None)
    again = claimed(jobs)
    assert (again.job_id, again.attempt, again.token) == (first.id, 1, 2)


def _claim_all(url: str, owner: str) -> list[str]:
    database = Database(url)
    jobs = JobRepository(database)
    found = []
    while (claim := jobs.claim(owner, LEASE_S)) is not None:
        found.append(claim.job_id)
        jobs.progress(claim, 50.0, "half", 1.0)
        jobs.succeed(claim, {"by": owner}, (), {})
    database.close()
    return found


@pytest.mark.parametrize("kind", ["threads", "processes"])
def test_two_workers_share_fifty_jobs_each_once(url: str, jobs: JobRepository, kind: str) -> None:
    ids = [submit(jobs).id for _ in range(50)]
    if kind == "threads":
        with ThreadPoolExecutor(2) as pool:
            found = list(pool.map(_claim_all, [url] * 2, ["one", "two"]))
    else:
        with multiprocessing.get_context("spawn").Pool(2) as pool:
            found = pool.starmap(_claim_all, [(url, "one"), (url, "two")])
    assert sorted(found[0] + found[1]) == sorted(ids)
    assert jobs.counts()["successful"] == 50
    for job in ids:
        statuses = [event.data["status"] for event in jobs.events(job) if event.kind == "status"]
        assert statuses == ["accepted", "running", "successful"]


@pytest.mark.parametrize("url", BACKENDS[1:], indirect=True)
def test_connections_that_the_server_ended_are_made_anew_unseen(url: str, jobs: JobRepository) -> None:
    job = submit(jobs)
    others = "FROM pg_stat_activity WHERE datname = current_database() AND pid <> pg_backend_pid()"
    engine = create_engine(make_url(url))
    with engine.connect() as connection:
        assert connection.scalar(text(f"SELECT count(pg_terminate_backend(pid)) {others}"))
        connection.commit()

        def alone() -> bool:
            connection.rollback()
            return connection.scalar(text(f"SELECT count(*) {others}")) == 0

        until(alone, "the end of the others' connections")
    engine.dispose()
    assert claimed(jobs).job_id == job.id
