"""The store, on every backend: submissions, and the lists of what was submitted."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from threading import Barrier
from typing import Any

import pytest

from safestart.errors import (
    Conflict,
    IdempotencyMismatch,
    InvalidInput,
    NotFound,
    QueueFull,
)
from safestart.runtime.access import Caller, Role
from safestart.store.access.audit import AuditLog
from safestart.store.database import Database
from safestart.store.jobs.filters import JobFilter
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.retention import Retention
from safestart.store.records import JobStatus
from tests.contract.store.store_jobs import claimed, submit
from tests.waiting import PATIENCE_S


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
    found = at_once(lambda _: submit(jobs, idempotency_key="k").id, 12)
    assert len(set(found)) == 1
    assert jobs.counts()["accepted"] == 1


def at_once(call: Callable[[int], Any], times: int) -> list[Any]:
    """Results of calls that all begin at the same moment."""
    start = Barrier(times)

    def one(number: int) -> Any:
        start.wait(PATIENCE_S)
        return call(number)

    with ThreadPoolExecutor(times) as pool:
        return list(pool.map(one, range(times)))


def test_many_at_once_do_not_overfill_the_queue(jobs: JobRepository) -> None:
    def accepted(_: int) -> bool:
        try:
            submit(jobs, max_queued=5)
        except QueueFull:
            return False
        return True

    assert sum(at_once(accepted, 15)) == 5
    assert jobs.counts()["accepted"] == 5


def test_many_at_once_take_a_turn_each(jobs: JobRepository) -> None:
    flood = at_once(lambda _: submit(jobs, submitter="a").id, 12)
    late = submit(jobs, submitter="b").id
    assert jobs.positions([late]) == {late: 2}, "after one of the others, not after all that came at once"
    assert sorted(jobs.positions(flood).values()) == [1, *range(3, 14)]


@pytest.mark.parametrize("key", ["", "k" * 256])
def test_a_key_of_unfit_length_is_refused(jobs: JobRepository, key: str) -> None:
    with pytest.raises(InvalidInput, match="required 1 to 255 characters"):
        submit(jobs, idempotency_key=key)


@pytest.mark.parametrize("key", ["k", "k" * 255])
def test_keys_of_the_shortest_and_the_longest_length_are_taken(jobs: JobRepository, key: str) -> None:
    assert submit(jobs, idempotency_key=key).id == submit(jobs, idempotency_key=key).id


def test_a_full_queue_refuses_more_but_returns_what_it_has(jobs: JobRepository) -> None:
    first = submit(jobs, max_queued=2, idempotency_key="k")
    submit(jobs, max_queued=2)
    with pytest.raises(QueueFull, match="required fewer than 2") as caught:
        submit(jobs, max_queued=2)
    assert caught.value.status == 429
    assert submit(jobs, max_queued=2, idempotency_key="k").id == first.id
    claimed(jobs)
    submit(jobs, max_queued=2)


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
    back: list[str] = []
    while page.prev_cursor:
        page = jobs.list(limit=3, cursor=page.prev_cursor)
        back = [job.id for job in page.jobs] + back
    assert back == [late, *ids[:0:-1]]  # the last page, of one job, was where we began
    onward = jobs.list(limit=3, cursor=page.next_cursor)
    assert onward.prev_cursor is not None
    assert jobs.list(limit=3).prev_cursor is None


def test_a_page_whose_jobs_were_deleted_meanwhile_is_empty(database: Database, jobs: JobRepository) -> None:
    old = submit(jobs).id
    submit(jobs)
    page = jobs.list(limit=1)
    jobs.dismiss(old)
    assert Retention(database).purge(-60.0) == 1
    after = jobs.list(limit=1, cursor=page.next_cursor)
    assert (after.jobs, after.next_cursor, after.prev_cursor) == ((), None, None)


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
    "cursor", ["", "x", "!!!", "YmVmb3JlOg", "YmVmb3JlOi0x", "é", "' OR 1=1", "QQ==", "9" * 40, "YWZ0ZXI6"]
)
def test_a_foreign_cursor_is_refused(jobs: JobRepository, cursor: str) -> None:
    with pytest.raises(
        InvalidInput, match="cursor: required the next_cursor or prev_cursor of an earlier page"
    ):
        jobs.list(cursor=cursor)


@pytest.mark.parametrize("limit", [0, -1, 1001])
def test_a_limit_out_of_range_is_refused(jobs: JobRepository, limit: int) -> None:
    with pytest.raises(InvalidInput, match="limit: required"):
        jobs.list(limit=limit)


def test_the_same_key_of_two_submitters_is_two_jobs(jobs: JobRepository) -> None:
    one, two = (submit(jobs, submitter=name, idempotency_key="k") for name in "ab")
    assert one.id != two.id
    assert submit(jobs, submitter="a", idempotency_key="k").id == one.id


def test_the_same_id_is_the_same_job(jobs: JobRepository, database: Database) -> None:
    """A submission is repeated whose answer was lost: the queue is full by then, and its key used."""
    by = Caller(None, "me", Role.SUBMIT, None)
    how: dict[str, Any] = {"job_id": "one", "idempotency_key": "k", "max_queued": 1, "by": by}
    first = submit(jobs, **how)
    before = [event.kind for event in jobs.events("one")]
    assert submit(jobs, **how) == first
    assert claimed(jobs).job_id == "one"
    assert submit(jobs, **how).status is JobStatus.RUNNING, "it may have begun meanwhile"
    assert (jobs.counts()["accepted"], jobs.counts()["running"]) == (0, 1)
    assert [event.kind for event in jobs.events("one")][: len(before)] == before
    assert len(AuditLog(database).entries().entries) == 1
    with pytest.raises(Conflict, match="job one is another request"):
        submit(jobs, **how, inputs={"a": 2})
