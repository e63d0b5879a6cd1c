"""The list of jobs: found, sorted, paged, named, cancelled and run again, several at a time."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from safestart.records.labels import Labels
from safestart.runtime.access import LOCAL
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.acceptance.running import serving
from tests.browser.conftest import Visit

INPUTS = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 5, "ny": 5, "y_max_m": 150}}
NO_GO = {"word": "NO_GO", "sense": "bad", "count": 2, "of": 5, "basis": None}


@pytest.fixture
def jobs(tmp_path: Path) -> JobRepository:
    database = Database(f"sqlite:///{tmp_path / 'list.sqlite3'}")
    database.migrate()
    return JobRepository(database)


@pytest.fixture
def list_page(browser: Browser, tmp_path: Path, jobs: JobRepository) -> Iterator[Visit]:
    with serving(f"sqlite:///{tmp_path / 'list.sqlite3'}") as url:
        context = browser.new_context(viewport={"width": 1280, "height": 900})
        visit = Visit(context, url)
        yield visit
        context.close()
        assert visit.faults() == []


def add(jobs: JobRepository, name: str = "", tags: tuple[str, ...] = (), process: str = "benchmark") -> str:
    labels = Labels(name=name, tags=list(tags))
    return jobs.submit(process, INPUTS, timeout_s=60.0, labels=labels).id


def runs(page: Page) -> list[str]:
    return page.locator(".jobs tbody .run > a").all_inner_texts()


def test_jobs_are_found_sorted_and_paged(list_page: Visit, jobs: JobRepository) -> None:
    for k in range(30):
        add(jobs, "run 07 seventh" if k == 7 else f"run {k:02}", ("odd",) if k % 2 else ())
    add(jobs, "other", ("odd one",), "coverage")
    page = list_page.go("/dashboard/jobs")
    expect(page.locator("#total")).to_have_text("31 jobs")
    expect(page.locator("#place")).to_have_text("1–25 of 31")
    page.click("#older")
    expect(page.locator("#place")).to_have_text("26–31 of 31")
    expect(page.locator(".jobs tbody tr")).to_have_count(6)
    page.click("th[data-sort=name] button")
    expect(page.locator("th[data-sort=name]")).to_have_attribute("aria-sort", "ascending")
    expect(page.locator("#place")).to_have_text("1–25 of 31")
    expect(page.locator(".jobs tbody .run > a").first).to_have_text("other")
    page.click("th[data-sort=name] button")
    expect(page.locator(".jobs tbody .run > a").first).to_have_text("run 29")
    page.fill("#search", "RUN Seventh")
    expect(page.locator("#total")).to_have_text("1 job found")
    page.fill("#search", "")
    expect(page.locator("#total")).to_have_text("31 jobs")
    page.locator(".jobs .tag", has_text="odd").first.click()
    expect(page.locator("#search")).to_have_value("#odd")
    expect(page.locator("#total")).to_have_text("15 jobs found")
    page.reload()
    expect(page.locator("#total")).to_have_text("15 jobs found")
    assert runs(page)[0] == "run 29", "order and search are in the address"
    page.select_option("#process", "coverage")
    expect(page.locator("#list")).to_contain_text("No job is like that")
    page.click("text=Show all")
    expect(page.locator("#total")).to_have_text("31 jobs")


def test_a_row_says_what_was_asked_and_what_came_out(list_page: Visit, jobs: JobRepository) -> None:
    add(jobs, "before the burn", ("envisat",), "go-no-go")
    claim = jobs.claim("tester", 60.0)
    assert claim is not None
    jobs.succeed(claim, {"outputs": {}}, (), {}, NO_GO)
    page = list_page.go("/dashboard/jobs?verdict=NO_GO")
    row = page.locator(".jobs tbody tr")
    expect(row.locator(".inputs")).to_contain_text("tumble rate 3 deg/s")
    expect(row.locator(".badge.job")).to_contain_text("successful")
    expect(row.locator(".badge.verdict")).to_contain_text("NO GO (2 of 5)")
    expect(row.locator(".run")).to_contain_text("go-no-go")
    list_page.shot("jobs-list")
    page.select_option("#verdict", "GO")
    expect(page.locator("#total")).to_have_text("0 jobs found")


def test_several_jobs_are_cancelled_and_run_again(list_page: Visit, jobs: JobRepository) -> None:
    for k in range(3):
        add(jobs, f"run {k}", ("t",))
    page = list_page.go("/dashboard/jobs")
    expect(page.locator(".jobs tbody tr")).to_have_count(3)
    expect(page.locator("#cancel")).to_be_disabled()
    page.get_by_label("choose all on this page").check()
    expect(page.locator("#chosen")).to_have_text("3 chosen")
    page.get_by_label("choose run 0").uncheck()
    jobs.submit("benchmark", INPUTS, timeout_s=60.0)
    expect(page.locator(".jobs tbody tr")).to_have_count(4)
    expect(page.get_by_label("choose run 1")).to_be_checked()
    page.click("#cancel")
    expect(page.locator("#cancel")).to_have_text("Really cancel 2 jobs")
    page.click("#cancel")
    expect(page.locator("#said")).to_have_text("2 cancelled.")
    assert jobs.counts()["dismissed"] == 2
    page.click("#again")
    expect(page.locator("#said")).to_have_text("2 queued again.")
    expect(page.locator("#total")).to_have_text("6 jobs")
    repeated = [job for job in jobs.list().jobs if job.name == "run 2" and job.status == "accepted"]
    assert [job.tags for job in repeated] == [["t"]], "name and tags go with it"


def test_a_second_look_before_several_are_cancelled(list_page: Visit, jobs: JobRepository) -> None:
    ended, waiting = add(jobs, "ended"), add(jobs, "waiting")
    page = list_page.go("/dashboard/jobs")
    page.get_by_label("choose all on this page").check()
    page.route("**/jobs?*", lambda route: route.abort())
    jobs.dismiss(ended, LOCAL)
    page.unroute("**/jobs?*")
    expect(page.locator("#cancel")).to_have_text("Cancel 1 of them")
    page.click("#cancel")
    expect(page.locator(f'[data-job="{waiting}"] .status')).to_have_text("cancelled")


def test_a_job_is_named_on_its_page(list_page: Visit, jobs: JobRepository) -> None:
    job = add(jobs)
    page = list_page.go(f"/dashboard/jobs/{job}")
    page.click("text=Name it, tag it, write a note")
    page.fill("#label-name", "before <b>the</b> burn")
    page.fill("#label-tags", "envisat, night shift,envisat")
    page.fill("#label-note", "first line\nsecond")
    page.wait_for_timeout(2500)
    expect(page.locator("#label-name")).to_have_value("before <b>the</b> burn")
    page.click("text=Save")
    expect(page.locator("h1")).to_contain_text("before <b>the</b> burn")
    expect(page.locator(".labels .written")).to_have_text("first line\nsecond")
    stored = jobs.get(job)
    assert (stored.tags, stored.note) == (["envisat", "night shift"], "first line\nsecond")
    list_page.shot("job-named")
    page.click(".labels >> text=night shift")
    expect(page).to_have_url(re.compile("search=%23night"))


def test_a_run_is_named_as_it_is_submitted(list_page: Visit, jobs: JobRepository) -> None:
    page = list_page.go("/dashboard/submit?process=benchmark")
    page.fill("#label-name", "named")
    page.fill("#label-tags", "a, b")
    page.click("#form button[type=submit]")
    page.wait_for_url(re.compile("/dashboard/jobs/[0-9a-f-]{36}"))
    assert (jobs.list().jobs[0].name, jobs.list().jobs[0].tags) == ("named", ["a", "b"])


@pytest.mark.parametrize("width", [390, 768])
def test_where_the_table_does_not_fit_nothing_is_out_of_sight(
    list_page: Visit, jobs: JobRepository, width: int
) -> None:
    """On a phone the outcome lay beyond the right edge."""
    add(jobs, "a name that is long enough for two lines of a phone", ("first", "second"))
    page = list_page.go("/dashboard/jobs")
    page.set_viewport_size({"width": width, "height": 844})
    expect(page.locator(".jobs tbody tr")).to_have_count(1)
    beyond = "[...document.querySelectorAll('.jobs *')].filter((one) => one.getBoundingClientRect().right > innerWidth)"
    assert page.evaluate(f"{beyond}.map((one) => one.outerHTML)") == []
    region = page.locator("#list .scroll")
    assert region.evaluate("(one) => one.scrollWidth - one.clientWidth") == 0
