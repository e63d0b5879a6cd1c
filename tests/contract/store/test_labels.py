"""Names, tags and notes of jobs, the outcome of their results, and the list that is searched and sorted by them."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import pytest

from safestart.errors import InvalidInput, NotFound
from safestart.records.labels import Labels
from safestart.store.access.audit import AuditLog
from safestart.store.backup import backup, restore
from safestart.store.database import Database
from safestart.store.jobs import listing
from safestart.store.jobs.filters import JobFilter, Order
from safestart.store.jobs.repository import JobRepository
from safestart.store.transfer import Transfer
from tests.contract.access.key_holders import BY
from tests.contract.store.store_backends import pass_time
from tests.contract.store.store_jobs import claimed, submit

GO = {"word": "GO", "sense": "good", "count": 1, "of": 1, "basis": None}
NO_GO = {"word": "NO_GO", "sense": "bad", "count": 2, "of": 3, "basis": None}


def found(jobs: JobRepository, by: Order = Order.CREATED, descending: bool = True, **wanted) -> list[str]:
    return [job.name for job in jobs.list(JobFilter(**wanted), by=by, descending=descending).jobs]


def test_labels_are_stored_and_written_later(database: Database, jobs: JobRepository) -> None:
    job = submit(
        jobs, labels=Labels(name=" before the burn ", tags=["envisat", "night", "envisat"], note="a\nb")
    )
    assert (job.name, job.tags, job.note) == ("before the burn", ["envisat", "night"], "a\nb")
    assert jobs.list().jobs[0].tags == ["envisat", "night"]
    now = jobs.label(job.id, name="after", by=BY)
    assert (now.name, now.tags, now.note) == ("after", ["envisat", "night"], "a\nb"), "the others stay"
    assert jobs.label(job.id, tags=[], note="").tags == []
    assert jobs.get(job.id) == jobs.label(job.id)
    entries = AuditLog(database).entries(subject=job.id).entries
    assert [(entry.action, entry.detail) for entry in entries] == [("label", {"changed": ["name"]})]
    with pytest.raises(NotFound):
        jobs.label("nothing", name="x")


def test_two_who_label_a_job_at_once_are_both_found(
    url: str, database: Database, jobs: JobRepository
) -> None:
    others = [JobRepository(Database(url)) for _ in range(2)]
    for k in range(10):
        job = submit(jobs).id
        start = Barrier(2)

        def label(who: int, job: str = job, start: Barrier = start, k: int = k) -> None:
            start.wait()
            others[who].label(job, **({"name": f"name {k}"} if who else {"tags": [f"tag {k}"]}))

        with ThreadPoolExecutor(2) as pool:
            list(pool.map(label, (0, 1)))
        assert found(jobs, words=[f"name {k}"[:4], str(k)], tags=[f"tag {k}"]) == [f"name {k}"]


@pytest.mark.parametrize(
    "wrong",
    [
        {"name": "x" * 101},
        {"name": "a\nb"},
        {"name": "a\0b"},
        {"name": "\u202eb"},
        {"name": "\ud800"},
        {"tags": ["a,b"]},
        {"tags": [" "]},
        {"tags": ["x" * 41]},
        {"tags": list("abcdefghijk")},
        {"tags": "night"},
        {"note": "x" * 2001},
        {"note": "\x1b[2J"},
    ],
)
def test_labels_beyond_their_bounds_are_refused(jobs: JobRepository, wrong) -> None:
    job = submit(jobs, labels=Labels(name="first"))
    with pytest.raises(InvalidInput, match=r"name|tags|note"):
        jobs.label(job.id, **wrong)
    assert jobs.get(job.id) == job


def test_a_list_is_searched_by_words_tags_and_outcome(jobs: JobRepository) -> None:
    for name, tags, process in (
        ("Burn one", ["Envisat"], "certificate"),
        ("burn TWO", ["envisat", "night shift"], "benchmark"),
        ("50 % of_it", ["envisat2"], "benchmark"),
        ("envisat", [], "flight"),
    ):
        submit(jobs, process, labels=Labels(name=name, tags=tags))
    claim = claimed(jobs)
    jobs.succeed(claim, {"outputs": {}}, (), {}, NO_GO)
    assert found(jobs, words=["BURN"]) == ["burn TWO", "Burn one"]
    assert found(jobs, words=["burn", "benchm"]) == ["burn TWO"]
    assert found(jobs, words=["%"]) == found(jobs, words=["f_i"]) == ["50 % of_it"], "no patterns"
    assert found(jobs, words=[claim.job_id[:13].upper()]) == ["Burn one"]
    assert found(jobs, tags=["ENVISAT"]) == ["burn TWO", "Burn one"], "whole tags, and no names"
    assert found(jobs, tags=["envisat", "night shift"]) == ["burn TWO"]
    assert found(jobs, verdicts=["NO_GO"]) == ["Burn one"]
    assert found(jobs, verdicts=["GO"]) == []
    page = jobs.list(JobFilter(words=["burn"]), limit=1)
    assert (page.total, page.jobs[0].name, page.prev_cursor) == (2, "burn TWO", None)
    assert jobs.list(JobFilter(words=["burn"]), limit=1, cursor=page.next_cursor).total == 2
    jobs.label(claim.job_id, name="renamed")
    assert found(jobs, words=["burn"]) == ["burn TWO"]


def test_few_and_many_that_are_found_are_the_same(jobs: JobRepository, monkeypatch) -> None:
    for k in range(12):
        submit(jobs, labels=Labels(name=f"{'even' if k % 2 == 0 else 'odd'} {k}"))
    pages = []
    for few in (1000, 2):
        monkeypatch.setattr(listing, "_FEW", few)
        first = jobs.list(JobFilter(words=["even"]), limit=4)
        last = jobs.list(JobFilter(words=["even"]), limit=4, cursor=first.next_cursor)
        pages.append((first, last, jobs.list(JobFilter(words=["even"]), by=Order.NAME, offset=1)))
    assert pages[0] == pages[1]
    assert [job.name for job in pages[0][1].jobs] == ["even 2", "even 0"]
    assert {page.total for page in pages[0]} == {6}


def test_a_list_is_sorted_by_what_is_asked(database: Database, jobs: JobRepository) -> None:
    for name, process in (("b", "coverage"), ("", "benchmark"), ("A", "flight")):
        submit(jobs, process, labels=Labels(name=name))
    claim = claimed(jobs)
    pass_time(database, 20.0)
    jobs.succeed(claim, {"outputs": {}}, (), {}, GO)
    claim = claimed(jobs)
    jobs.succeed(claim, {"outputs": {}}, (), {}, None)
    assert found(jobs, Order.CREATED, descending=False) == ["b", "", "A"]
    assert found(jobs, Order.NAME, descending=False) == ["A", "b", ""], "those without a value are last"
    assert found(jobs, Order.NAME) == ["b", "A", ""]
    assert found(jobs, Order.DURATION) == ["b", "", "A"]
    assert found(jobs, Order.DURATION, descending=False) == ["", "b", "A"]
    assert found(jobs, Order.PROCESS, descending=False) == ["", "b", "A"]
    assert found(jobs, Order.VERDICT) == ["b", "A", ""]
    assert found(jobs, Order.STATUS, descending=False) == ["A", "", "b"]
    pages = [jobs.list(by=Order.NAME, limit=1, offset=k) for k in range(3)]
    assert [page.jobs[0].name for page in pages] == ["b", "A", ""]
    assert {page.total for page in pages} == {3}
    cursor = jobs.list(limit=1).next_cursor
    with pytest.raises(InvalidInput, match="cursor"):
        jobs.list(cursor=cursor, by=Order.NAME)
    with pytest.raises(InvalidInput, match="offset"):
        jobs.list(offset=-1)


def test_a_page_has_inputs_unless_they_are_long(jobs: JobRepository) -> None:
    submit(jobs, inputs={"a": 1})
    submit(jobs, inputs={"a": "x" * 30_000})
    assert jobs.list().inputs == (None, {"a": 1})


def test_bundles_and_backups_keep_labels(database: Database, jobs: JobRepository, tmp_path) -> None:
    labels = Labels(name="kept", tags=["a", "b"], note="why")
    job = submit(jobs, labels=labels)
    plain = submit(jobs)
    for outcome in (GO, None):
        jobs.succeed(claimed(jobs), {"outputs": {}, "provenance": {"artifacts": {}}}, (), {}, outcome)
    assert not {"name", "tags", "note"} & set(Transfer(database).read(plain.id).job)
    bundle = Transfer(database).read(job.id)
    assert {key: bundle.job[key] for key in ("name", "tags", "note")} == labels.model_dump()
    other = Database(f"sqlite:///{tmp_path / 'other.sqlite3'}")
    other.migrate()
    Transfer(other).add(bundle, GO)
    there = JobRepository(other)
    assert (there.get(job.id).name, there.get(job.id).outcome) == ("kept", GO)
    assert found(there, tags=["b"], verdicts=["GO"]) == ["kept"]
    other.close()
    file, third = tmp_path / "copy.sqlite3", Database(f"sqlite:///{tmp_path / 'third.sqlite3'}")
    backup(database, file)
    restore(third, file)
    assert JobRepository(third).get(job.id) == jobs.get(job.id)
    assert found(JobRepository(third), words=["kept"]) == ["kept"]
    third.close()
