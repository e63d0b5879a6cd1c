"""The store, on every backend: whose turn it is, and when."""

from __future__ import annotations

import pytest

from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.records import JobStatus, Wait
from tests.contract.store.store_backends import pass_time
from tests.contract.store.store_jobs import claimed, submit
from tests.waiting import PATIENCE_S


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


def test_a_job_that_came_back_gives_its_old_turn_to_nobody(jobs: JobRepository) -> None:
    flood = [submit(jobs, submitter="a").id for _ in range(8)]
    claims = [claimed(jobs) for _ in range(5)]
    jobs.release(claims[0], "stopped")
    late = [submit(jobs, submitter="b").id for _ in range(3)]
    order = [claimed(jobs).job_id for _ in range(5)]
    assert order == [flood[0], flood[5], late[0], flood[6], late[1]]


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


def test_the_wait_counts_what_runs_and_what_is_ahead_by_their_processes(
    database: Database, jobs: JobRepository
) -> None:
    for process, run_s in (("short", 1e5), ("long", 4e5)):
        submit(jobs, process)
        claim = claimed(jobs)
        pass_time(database, run_s)
        jobs.succeed(claim, {}, (), {})
    for process in ("short", "long"):
        submit(jobs, process)
    half, known = claimed(jobs), claimed(jobs)
    jobs.progress(known, 50.0, "half", 3e5)
    waiting = [submit(jobs, process, priority=0).id for process in ("short", "new", "long")]
    jobs.heartbeat("worker", 4, 2)
    busy = 1e5 / 2 + 3e5  # half of the mean where the job says nothing, else what it says
    means = {"short": 1e5, "new": (1e5 + 4e5) / 2, "long": 4e5}
    close = dict(rel=0.0, abs=PATIENCE_S)
    assert jobs.wait(waiting[0]) == Wait(1, 0.0, pytest.approx(means["short"], **close))
    assert jobs.wait(waiting[1]) == Wait(2, 0.0, pytest.approx(means["new"], **close))
    starts = (busy + means["short"] + means["new"]) / 4
    ends = starts + means["long"]
    assert jobs.wait(waiting[2]) == Wait(3, pytest.approx(starts, **close), pytest.approx(ends, **close))
    jobs.succeed(half, {}, (), {})
    submit(jobs, "new", priority=1)
    found = jobs.wait(waiting[0])
    assert found is not None
    assert (found.position, found.starts_in_s, found.higher, found.turns) == (2, 0.0, 1, 0)


def test_a_waiting_job_knows_who_is_ahead_and_why(jobs: JobRepository) -> None:
    flood = [submit(jobs, submitter="a").id for _ in range(3)]
    submit(jobs, submitter="b")
    submit(jobs, submitter="b", priority=1)
    waits = [jobs.wait(job) for job in flood]
    assert waits == [Wait(2, None, None, 1, 0), Wait(4, None, None, 1, 1), Wait(5, None, None, 1, 1)]


def test_counts(jobs: JobRepository) -> None:
    assert jobs.counts() == {status.value: 0 for status in JobStatus}
    submit(jobs)
    submit(jobs)
    claimed(jobs)
    assert jobs.counts() == {"accepted": 1, "running": 1, "successful": 0, "failed": 0, "dismissed": 0}
