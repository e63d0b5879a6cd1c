"""The contract of the store, the same on every backend."""

from __future__ import annotations

import multiprocessing
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import create_engine, make_url, text

from safestart.artifact import Artifact
from safestart.comparable import comparable, digest
from safestart.errors import (
    Conflict,
    IdempotencyMismatch,
    InvalidInput,
    JobFailed,
    LeaseLost,
    NotFound,
    QueueFull,
    ResultNotReady,
    Unavailable,
)
from safestart.store import schema
from safestart.store.database import Database
from safestart.store.filters import JobFilter
from safestart.store.jobs import JobRepository
from safestart.store.models import Base
from safestart.store.records import Claim, Job, JobStatus, Wait
from safestart.store.results import ResultRepository
from tests.contract.store_backends import BACKENDS, fresh_url, pass_time
from tests.waiting import PATIENCE_S, until

LEASE_S = 30.0


@pytest.fixture(params=BACKENDS)
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    return fresh_url(request.param, tmp_path)


@pytest.fixture
def database(url: str) -> Iterator[Database]:
    database = Database(url)
    database.migrate()
    yield database
    database.close()


@pytest.fixture
def jobs(database: Database) -> JobRepository:
    return JobRepository(database)


@pytest.fixture
def results(database: Database) -> ResultRepository:
    return ResultRepository(database)


def submit(jobs: JobRepository, process_id: str = "certificate", **more) -> Job:
    return jobs.submit(process_id, more.pop("inputs", {"a": 1}), timeout_s=60.0, **more)


def claimed(jobs: JobRepository, lease_s: float = LEASE_S, **more) -> Claim:
    claim = jobs.claim("worker", lease_s, **more)
    assert claim is not None
    return claim


def lapse(database: Database) -> None:
    """The time of a lease passes."""
    pass_time(database, LEASE_S + 1.0)


# --- submission ---


def test_a_submitted_job_reads_back_as_it_was_given(jobs: JobRepository) -> None:
    inputs = {"b": [1.5, None, {"ä": "ü\u2028"}], "a": 1e-300, "big": 2**63 - 1}
    job = jobs.submit("benchmark", inputs, instant={"r_sync_m": 72.95}, timeout_s=12.5)
    assert job == jobs.get(job.id)
    assert (job.process_id, job.status, job.inputs) == ("benchmark", JobStatus.ACCEPTED, inputs)
    assert list(job.inputs) == ["b", "a", "big"]
    assert job.instant == {"r_sync_m": 72.95}
    assert (job.timeout_s, job.attempts, job.progress) == (12.5, 0, 0.0)
    assert job.owner is None
    assert job.created_at.tzinfo is not None
    assert abs(datetime.now(UTC) - job.created_at) < timedelta(seconds=30)


def test_an_unknown_job_is_not_found(jobs: JobRepository) -> None:
    for call in (jobs.get, jobs.position, jobs.dismiss):
        with pytest.raises(NotFound, match="no job 'nope'"):
            call("nope")
    assert jobs.events("nope") == ()


@pytest.mark.parametrize("wrong", [{"x": float("nan")}, {"x": float("inf")}, {"x": object()}])
def test_inputs_that_are_not_json_are_refused(jobs: JobRepository, wrong: dict) -> None:
    with pytest.raises(InvalidInput, match="inputs: required a JSON object"):
        submit(jobs, inputs=wrong)
    assert jobs.counts()["accepted"] == 0


def test_the_same_key_and_body_is_the_same_job(jobs: JobRepository) -> None:
    first = submit(jobs, idempotency_key="k", inputs={"a": 1, "b": 2})
    assert submit(jobs, idempotency_key="k", inputs={"b": 2, "a": 1}).id == first.id
    assert submit(jobs, idempotency_key="other").id != first.id
    assert jobs.counts()["accepted"] == 2


@pytest.mark.parametrize("other", [{"inputs": {"a": 2}}, {"process_id": "coverage"}])
def test_the_same_key_with_another_body_is_refused(jobs: JobRepository, other: dict) -> None:
    first = submit(jobs, idempotency_key="k")
    with pytest.raises(IdempotencyMismatch, match=first.id) as caught:
        submit(jobs, idempotency_key="k", **other)
    assert caught.value.status == 422


def test_one_key_from_many_threads_is_one_job(jobs: JobRepository) -> None:
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda _: submit(jobs, idempotency_key="k").id, range(24)))
    assert len(set(found)) == 1
    assert jobs.counts()["accepted"] == 1


@pytest.mark.parametrize("key", ["", "k" * 256])
def test_a_key_of_unfit_length_is_refused(jobs: JobRepository, key: str) -> None:
    with pytest.raises(InvalidInput, match="required 1 to 255 characters"):
        submit(jobs, idempotency_key=key)


def test_a_full_queue_refuses_more_but_returns_what_it_has(jobs: JobRepository) -> None:
    first = submit(jobs, max_queued=2, idempotency_key="k")
    submit(jobs, max_queued=2)
    with pytest.raises(QueueFull, match="required fewer than 2") as caught:
        submit(jobs, max_queued=2)
    assert caught.value.status == 429
    assert submit(jobs, max_queued=2, idempotency_key="k").id == first.id
    claimed(jobs)
    submit(jobs, max_queued=2)


# --- lists, positions, counts ---


def test_pages_are_newest_first_and_complete(jobs: JobRepository) -> None:
    ids = [submit(jobs).id for _ in range(7)]
    seen: list[str] = []
    page = jobs.list(limit=3)
    seen += [job.id for job in page.jobs]
    late = submit(jobs).id  # submitted meanwhile: shifts nothing
    while page.next_cursor:
        page = jobs.list(limit=3, cursor=page.next_cursor)
        seen += [job.id for job in page.jobs]
    assert seen == ids[::-1]
    assert jobs.list(limit=1).jobs[0].id == late


def test_a_last_page_that_is_full_has_no_cursor(jobs: JobRepository) -> None:
    for _ in range(3):
        submit(jobs)
    assert jobs.list(limit=3).next_cursor is None
    assert len(jobs.list(limit=3).jobs) == 3


def test_lists_are_filtered(jobs: JobRepository) -> None:
    first, second, third = submit(jobs), submit(jobs, "coverage"), submit(jobs)
    jobs.dismiss(third.id)
    of = lambda **by: {job.id for job in jobs.list(JobFilter(**by)).jobs}  # noqa: E731
    assert of(statuses=[JobStatus.ACCEPTED]) == {first.id, second.id}
    assert of(process_ids=["certificate"]) == {first.id, third.id}
    assert of(statuses=[JobStatus.ACCEPTED], process_ids=["certificate"]) == {first.id}
    assert of(statuses=["accepted", "dismissed"]) == {first.id, second.id, third.id}
    assert of(process_ids=["none"]) == set()
    claim = claimed(jobs)
    jobs.succeed(claim, {"outputs": {}}, (), {})
    assert of(least_s=0.0, most_s=60.0) == {claim.job_id}, "one that never started has no duration"
    assert of(least_s=60.0) == set()
    now = datetime.now(UTC)
    assert of(created_from=now - timedelta(hours=1), created_to=now + timedelta(hours=1)) == {
        first.id,
        second.id,
        third.id,
    }
    assert of(created_to=now - timedelta(hours=1)) == set()


@pytest.mark.parametrize(
    "cursor", ["", "x", "!!!", "YmVmb3JlOg", "YmVmb3JlOi0x", "é", "' OR 1=1", "QQ==", "9" * 40]
)
def test_a_foreign_cursor_is_refused(jobs: JobRepository, cursor: str) -> None:
    with pytest.raises(InvalidInput, match="cursor: required the next_cursor of an earlier page"):
        jobs.list(cursor=cursor)


@pytest.mark.parametrize("limit", [0, -1, 1001])
def test_a_limit_out_of_range_is_refused(jobs: JobRepository, limit: int) -> None:
    with pytest.raises(InvalidInput, match="limit: required"):
        jobs.list(limit=limit)


def test_positions_follow_priority_then_age_and_so_do_claims(jobs: JobRepository) -> None:
    low, high, later = submit(jobs), submit(jobs, priority=5), submit(jobs)
    assert [jobs.position(job.id) for job in (high, low, later)] == [1, 2, 3]
    assert claimed(jobs).job_id == high.id
    assert jobs.position(high.id) is None
    assert [jobs.position(job.id) for job in (low, later)] == [1, 2]
    assert claimed(jobs).job_id == low.id


def test_submitters_take_turns_whatever_they_have_queued(jobs: JobRepository) -> None:
    flood = [submit(jobs, submitter="a").id for _ in range(6)]
    claimed(jobs)
    late = [submit(jobs, submitter="b").id for _ in range(2)]
    order = [claimed(jobs).job_id for _ in range(7)]
    assert order == [flood[1], late[0], flood[2], late[1], flood[3], flood[4], flood[5]]


def test_turns_count_among_equal_priorities_only_and_positions_tell_them(jobs: JobRepository) -> None:
    flood = [submit(jobs, submitter="a").id for _ in range(3)]
    first, low = submit(jobs, submitter="b").id, submit(jobs, submitter="b", priority=-1).id
    expected = [flood[0], first, flood[1], flood[2], low]
    places = jobs.positions([*flood, first, low, "nope"])
    assert sorted(places, key=places.__getitem__) == expected
    assert [jobs.position(job) for job in expected] == [1, 2, 3, 4, 5]
    assert [claimed(jobs).job_id for _ in range(5)] == expected


def test_a_released_job_is_next_even_when_turns_began_anew(jobs: JobRepository) -> None:
    jobs_of_a = [submit(jobs, submitter="a").id for _ in range(3)]
    claims = [claimed(jobs) for _ in range(3)]
    later = submit(jobs, submitter="b").id
    jobs.release(claims[2], "stopped")
    assert [claimed(jobs).job_id for _ in range(2)] == [jobs_of_a[2], later]


def test_the_same_key_of_two_submitters_is_two_jobs(jobs: JobRepository) -> None:
    one, two = (submit(jobs, submitter=name, idempotency_key="k") for name in "ab")
    assert one.id != two.id
    assert submit(jobs, submitter="a", idempotency_key="k").id == one.id


def test_a_waiting_job_knows_when_it_will_start(database: Database, jobs: JobRepository) -> None:
    done = submit(jobs)
    assert jobs.wait(done.id) == Wait(1, None, None)  # no history, no worker
    claim = claimed(jobs)
    pass_time(database, 20.0)
    jobs.succeed(claim, {}, (), {})
    assert jobs.wait(done.id) is None
    ids = [submit(jobs).id for _ in range(5)]
    assert jobs.wait(ids[0]) == Wait(1, None, None)  # still no worker
    jobs.heartbeat("worker", 2, 0)
    first, last = jobs.wait(ids[0]), jobs.wait(ids[4])
    assert first is not None
    assert (first.position, first.starts_in_s) == (1, 0.0)
    assert last is not None
    run_s = first.ends_in_s
    assert run_s is not None
    assert 20.0 <= run_s < 20.0 + PATIENCE_S
    assert last == Wait(5, pytest.approx(4 * run_s / 2), pytest.approx(4 * run_s / 2 + run_s))


def test_counts_and_the_oldest_waiting(jobs: JobRepository) -> None:
    assert jobs.counts() == {status.value: 0 for status in JobStatus}
    assert jobs.waiting_since() is None
    first = submit(jobs)
    submit(jobs)
    assert jobs.waiting_since() == first.created_at
    claimed(jobs)
    assert jobs.counts() == {"accepted": 1, "running": 1, "successful": 0, "failed": 0, "dismissed": 0}


# --- claims ---


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


def test_a_job_that_lost_its_worker_and_its_task_processes_says_both(
    database: Database, jobs: JobRepository
) -> None:
    job = submit(jobs)
    claimed(jobs)
    lapse(database)
    claim = claimed(jobs)
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
    assert ended.finished_at is not None


def test_a_released_job_waits_at_its_old_place_and_lost_no_attempt(jobs: JobRepository) -> None:
    first, second = submit(jobs), submit(jobs)
    claim = claimed(jobs)
    jobs.release(claim, "the worker stops")
    job = jobs.get(first.id)
    assert (job.status, job.attempts, job.owner) == (JobStatus.ACCEPTED, 0, None)
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


# --- dismissal ---


def test_a_waiting_job_is_dismissed_at_once(jobs: JobRepository, results: ResultRepository) -> None:
    job = submit(jobs)
    ended = jobs.dismiss(job.id)
    assert ended.status is JobStatus.DISMISSED
    assert ended.finished_at is not None
    assert jobs.dismiss(job.id) == ended
    assert jobs.claim("worker", LEASE_S) is None
    with pytest.raises(NotFound, match="was dismissed"):
        results.result(job.id)


def test_a_running_job_is_asked_to_stop_and_its_worker_ends_it(jobs: JobRepository) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    asked = jobs.dismiss(job.id)
    assert (asked.status, asked.cancel_requested) == (JobStatus.RUNNING, True)
    assert jobs.dismiss(job.id) == asked
    assert jobs.renew(claim, LEASE_S) is False
    jobs.dismissed(claim)
    assert jobs.get(job.id).status is JobStatus.DISMISSED


@pytest.mark.parametrize("end", ["succeed", "fail", "release"])
def test_a_job_asked_to_stop_ends_dismissed_however_it_ends(
    jobs: JobRepository, results: ResultRepository, end: str
) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    jobs.dismiss(job.id)
    if end == "succeed":
        jobs.succeed(claim, {"a": 1}, (Artifact("a", "text/plain", b""),), {})
    elif end == "fail":
        jobs.fail(claim, {"detail": "x"})
    else:
        jobs.release(claim, "x")
    assert jobs.get(job.id).status is JobStatus.DISMISSED
    assert results.artifacts(job.id) == ()


def test_a_running_job_without_a_worker_is_dismissed_at_once(database: Database, jobs: JobRepository) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    lapse(database)
    assert jobs.dismiss(job.id).status is JobStatus.DISMISSED
    with pytest.raises(LeaseLost):
        jobs.succeed(claim, {}, (), {})


def test_a_dismissed_job_whose_worker_vanished_ends_when_the_next_one_looks(
    database: Database, jobs: JobRepository
) -> None:
    job = submit(jobs)
    claimed(jobs)
    jobs.dismiss(job.id)
    lapse(database)
    assert jobs.claim("other", LEASE_S) is None
    assert jobs.get(job.id).status is JobStatus.DISMISSED


def test_an_ended_job_cannot_be_dismissed(jobs: JobRepository) -> None:
    job = submit(jobs)
    jobs.succeed(claimed(jobs), {}, (), {})
    with pytest.raises(Conflict, match="has ended"):
        jobs.dismiss(job.id)


# --- results ---


def test_a_result_is_stored_with_its_artifacts_and_hash(
    jobs: JobRepository, results: ResultRepository
) -> None:
    job = submit(jobs)
    document = {"schema_version": 3, "outputs": {"iou": 0.5, "rows": [{"run_s": 1.0}]}}
    files = (Artifact("b.npz", "application/x-npz", bytes(range(256))), Artifact("a.png", "image/png", b""))
    jobs.succeed(claimed(jobs), document, files, {"python": "3.13"})
    ended, stored = jobs.get(job.id), results.result(job.id)
    assert (ended.status, ended.progress, ended.versions) == (JobStatus.SUCCESSFUL, 100.0, {"python": "3.13"})
    assert (stored.document, stored.schema_version, stored.sha256) == (document, 3, digest(document))
    assert [(info.name, info.size, info.sha256) for info in results.artifacts(job.id)] == [
        ("a.png", 0, files[1].sha256),
        ("b.npz", 256, files[0].sha256),
    ]
    assert results.artifact(job.id, "b.npz") == files[0]
    with pytest.raises(NotFound, match=r"there are: a\.png, b\.npz"):
        results.artifact(job.id, "c")


def test_a_result_that_cannot_be_stored_leaves_nothing_behind(
    jobs: JobRepository, results: ResultRepository
) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    twice = (Artifact("a", "text/plain", b"1"), Artifact("a", "text/plain", b"2"))
    with pytest.raises(Unavailable):
        jobs.succeed(claim, {"a": 1}, twice, {})
    assert jobs.get(job.id).status is JobStatus.RUNNING
    with pytest.raises(ResultNotReady):
        results.result(job.id)
    jobs.succeed(claim, {"a": 1}, twice[:1], {})


def test_no_result_before_the_end_and_the_reason_after_a_failure(
    jobs: JobRepository, results: ResultRepository
) -> None:
    job = submit(jobs)
    with pytest.raises(ResultNotReady, match="is accepted") as caught:
        results.result(job.id)
    assert (caught.value.status, caught.value.slug) == (404, "result-not-ready")
    claim = claimed(jobs)
    with pytest.raises(ResultNotReady, match="is running"):
        results.artifact(job.id, "a")
    problem = {"type": "urn:x", "title": "T", "status": 422, "detail": "a_max_m_s2 is wrong"}
    jobs.fail(claim, problem)
    with pytest.raises(JobFailed, match="failed: a_max_m_s2 is wrong"):
        results.result(job.id)
    assert jobs.get(job.id).problem == problem
    for call in (results.result, results.artifacts):
        with pytest.raises(NotFound):
            call("nope")


def test_what_makes_two_results_the_same() -> None:
    one = {"outputs": {"rows": [{"run_s": 1.0, "iou": 0.5}]}, "provenance": {"started": "a", "seed": 1}}
    two = {"provenance": {"seed": 1, "started": "b"}, "outputs": {"rows": [{"iou": 0.5, "run_s": 2.0}]}}
    assert comparable(one) == comparable(two)
    assert digest(one) == digest(two)
    assert digest(one) != digest({"outputs": {"rows": [{"run_s": 1.0, "iou": 0.6}]}})


# --- events, workers ---


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
    assert jobs.workers_alive() == 0
    jobs.heartbeat("one", 2, 0)
    jobs.heartbeat("one", 2, 1)
    jobs.heartbeat("two", 4, 0)
    assert jobs.workers_alive() == 2
    pass_time(database, PATIENCE_S)
    jobs.heartbeat("two", 4, 0)
    assert jobs.workers_alive(within_s=PATIENCE_S) == 1
    jobs.farewell("two")
    assert jobs.workers_alive(within_s=2 * PATIENCE_S) == 1


# --- shards ---


def test_finished_shards_are_kept_in_order_and_go_with_the_success(jobs: JobRepository) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    jobs.save_shard(claim, 2, "c2", {"n": 2}, b"two")
    jobs.save_shard(claim, 0, "c0", {"n": 0}, b"")
    jobs.save_shard(claim, 2, "c2", {"n": 22}, b"again")
    assert jobs.shard_contents(job.id) == {0: "c0", 2: "c2"}
    assert jobs.shard_documents(job.id) == ({"n": 0}, {"n": 22})
    assert [(shard.number, shard.data) for shard in jobs.shards(job.id)] == [(0, b""), (2, b"again")]
    jobs.succeed(claim, {"outputs": {}}, (), {})
    assert jobs.shards(job.id) == ()


def test_a_worker_that_lost_its_lease_adds_no_shard(database: Database, jobs: JobRepository) -> None:
    job = submit(jobs)
    late = claimed(jobs)
    jobs.save_shard(late, 0, "c", {}, b"")
    lapse(database)
    claimed(jobs)
    with pytest.raises(LeaseLost):
        jobs.save_shard(late, 1, "c", {}, b"")
    assert jobs.shard_contents(job.id) == {0: "c"}, "what was finished in time is there for the next worker"


def test_attempts_count_from_the_last_finished_shard(database: Database, jobs: JobRepository) -> None:
    job = submit(jobs)
    for _ in range(2):
        claim = claimed(jobs, max_attempts=2)
        lapse(database)
    claim = replace(claim)
    with pytest.raises(LeaseLost):
        jobs.save_shard(replace(claim, token=claim.token - 1), 0, "c", {}, b"")
    jobs.save_shard(claim, 0, "c", {}, b"")
    assert claimed(jobs, max_attempts=2).attempt == 2
    assert jobs.get(job.id).status is JobStatus.RUNNING


def test_shards_of_a_job_that_failed_stay(jobs: JobRepository) -> None:
    job = submit(jobs)
    claim = claimed(jobs)
    jobs.save_shard(claim, 0, "c", {"n": 1}, b"")
    jobs.fail(claim, {"detail": "no"})
    assert jobs.shard_documents(job.id) == ({"n": 1},)


# --- the database itself ---


def test_the_migrations_make_the_tables_of_the_models(database: Database) -> None:
    database.migrate()
    with database.session() as session:
        context = MigrationContext.configure(session.connection())
        assert compare_metadata(context, Base.metadata) == []
        assert schema.version(session.connection()) == schema.HEAD


def test_processes_that_migrate_at_once_all_succeed(url: str) -> None:
    code = "import sys; from safestart.store.database import Database; Database(sys.argv[1]).migrate()"
    started = [
        subprocess.Popen([sys.executable, "-c", code, url], stderr=subprocess.PIPE, text=True)
        for _ in range(4)
    ]
    for process in started:
        _, said = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0, said


def test_a_newer_schema_is_refused(database: Database) -> None:
    from sqlalchemy import text

    with database.session(write=True) as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(Unavailable, match="a schema this version does not know"):
        database.migrate()


def test_ping_answers(database: Database) -> None:
    database.ping()


@pytest.mark.parametrize(
    ("wrong", "kind", "said"),
    [
        ("mysql://user:hunter2@host/name", InvalidInput, "required sqlite:///PATH"),
        ("rubbish hunter2", InvalidInput, "required sqlite:///PATH"),
        ("", InvalidInput, "required sqlite:///PATH"),
        ("sqlite://", InvalidInput, "in memory"),
        ("sqlite:////nonexistent/folder/file.sqlite3", Unavailable, "existing, writable directory"),
        ("sqlite:////", Unavailable, "existing, writable directory"),
        ("postgresql://user:hunter2@127.0.0.1:9/name", Unavailable, "postgresql"),
    ],
)
def test_a_database_that_cannot_be_says_what_is_required(
    wrong: str, kind: type[Exception], said: str
) -> None:
    with pytest.raises(kind) as caught:
        Database(wrong).migrate()
    assert said in str(caught.value)
    assert "hunter2" not in str(caught.value)


def test_a_file_that_is_no_database_is_unavailable(tmp_path: Path) -> None:
    (tmp_path / "x").write_text("not a database, but long enough to have a header to look at " * 20)
    with pytest.raises(Unavailable, match="file is not a database"):
        Database(f"sqlite:///{tmp_path / 'x'}").ping()


def test_another_error_rolls_back_and_passes_through(database: Database, jobs: JobRepository) -> None:
    from sqlalchemy import text

    job = submit(jobs)

    def half_a_change() -> None:
        with database.session(write=True) as session:
            session.execute(text("UPDATE jobs SET message = 'half'"))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        half_a_change()
    assert jobs.get(job.id).message == ""
