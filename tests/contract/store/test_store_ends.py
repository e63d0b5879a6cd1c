"""The store, on every backend: dismissals and results."""

from __future__ import annotations

import pytest

from safestart.errors import (
    Conflict,
    JobFailed,
    LeaseLost,
    NotFound,
    ResultNotReady,
    Unavailable,
)
from safestart.records.artifact import Artifact
from safestart.records.comparable import comparable, digest
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.results import ResultRepository
from safestart.store.records import JobStatus
from tests.contract.store.store_jobs import LEASE_S, claimed, lapse, submit


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


def test_a_worker_may_end_its_job_as_dismissed_unasked(jobs: JobRepository) -> None:
    job = submit(jobs)
    jobs.dismissed(claimed(jobs))
    ended = jobs.get(job.id)
    assert (ended.status, ended.message, ended.cancel_requested) == (JobStatus.DISMISSED, "dismissed", True)


@pytest.mark.parametrize(
    ("problem", "message"),
    [({"title": "T", "detail": "D"}, "D"), ({"title": "T"}, "T"), ({"status": 500}, "failed")],
)
def test_a_failure_says_what_it_can(jobs: JobRepository, problem: dict, message: str) -> None:
    job = submit(jobs)
    jobs.fail(claimed(jobs), problem)
    assert jobs.get(job.id).message == message
    assert jobs.events(job.id)[-1].data == {"status": "failed", "message": message}


def test_an_ended_job_cannot_be_dismissed(jobs: JobRepository) -> None:
    job = submit(jobs)
    jobs.succeed(claimed(jobs), {}, (), {})
    with pytest.raises(Conflict, match="has ended"):
        jobs.dismiss(job.id)


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


@pytest.mark.parametrize("text", ["a\0b", "a\ud800b"])
def test_a_job_ends_whatever_its_messages_hold(jobs: JobRepository, text: str) -> None:
    submit(jobs)
    claim = claimed(jobs)
    jobs.progress(claim, 1.0, text, None)
    jobs.fail(claim, {"detail": text})
    job = jobs.get(claim.job_id)
    assert (job.status, job.message) == (JobStatus.FAILED, "a?b")
