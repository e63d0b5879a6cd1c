"""What users do with the pages: keys, lists that refresh, cancelled runs, lost paths, flights on small screens."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.proofs.single import check
from safestart.runtime.access import LOCAL, Role
from safestart.store.access.keys import KeyRepository
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.acceptance.running import serving
from tests.browser.conftest import Visit
from tests.browser.first_screen import check_first_screen
from tests.waiting import until


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    return f"sqlite:///{tmp_path_factory.mktemp('handling') / 'handling.sqlite3'}"


@pytest.fixture(scope="module")
def database(address: str) -> Database:
    found = Database(address)
    found.migrate()
    return found


@pytest.fixture(scope="module")
def url(address: str) -> Iterator[str]:
    with serving(address) as found:
        yield found


def opened(browser: Browser, url: str, width: int = 1280, height: int = 800) -> Visit:
    context = browser.new_context(viewport={"width": width, "height": height}, accept_downloads=True)
    return Visit(context, url)


def close(visit: Visit) -> None:
    visit.page.context.close()
    assert visit.faults() == []


def test_a_refresh_keeps_the_focus(browser: Browser, url: str, database: Database) -> None:
    """Seen: every 1.5 s the list was made anew, and the focus fell to the top of the page."""
    jobs = JobRepository(database)
    first = jobs.submit("benchmark", {}, instant=None, timeout_s=60.0).id
    visit = opened(browser, url)
    page = visit.go("/dashboard/jobs")
    page.locator(f'[data-job="{first}"] [data-control="cancel"]').focus()
    second = jobs.submit("benchmark", {}, instant=None, timeout_s=60.0).id
    expect(page.locator(f'[data-job="{second}"]')).to_be_visible()
    where = (
        "[document.activeElement.closest('[data-job]')?.dataset.job, document.activeElement.dataset.control]"
    )
    assert page.evaluate(where) == [first, "cancel"]
    jobs.dismiss(first, LOCAL)
    expect(page.locator(f'[data-job="{first}"] .status')).to_have_text("cancelled")
    assert page.evaluate(where)[0] == first, "its row has changed, and still has the focus"
    jobs.dismiss(second, LOCAL)
    close(visit)


def test_a_path_where_nothing_is(browser: Browser, url: str) -> None:
    visit = opened(browser, url)
    visit.allowed.append("404")
    page = visit.go("/dashboard/nowhere")
    expect(page.locator("h1")).to_have_text("Nothing is here")
    expect(page.locator("main code")).to_have_text("/dashboard/nowhere")
    visit.shot("not-found")
    of_menu, of_page = (page.locator(f"{part} a").all_inner_texts() for part in ("header nav", "main li"))
    assert of_page == of_menu, "it offers every page"
    page.click("main >> text=Jobs")
    expect(page.locator("h1")).to_have_text("Jobs")
    answer = page.request.get(f"{url}/nowhere", headers={"Accept": "application/json"})
    assert answer.status == 404
    assert answer.json()["title"] == "Not Found", "a program gets its problem document"
    close(visit)


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (390, 844)])
def test_map_and_clock_on_one_screen_in_both_frames(
    browser: Browser, url: str, width: int, height: int
) -> None:
    visit = opened(browser, url, width, height)
    page = visit.go("/dashboard?omega_t_deg_s=3&x_m=5&y_m=40")
    expect(page.locator("#play")).to_be_enabled()
    for frame in ("body", "lvlh", "body"):
        page.select_option("#frame", frame)
        expect(page.locator("#map .xtitle")).to_contain_text("LVLH" if frame == "lvlh" else "body frame")
        seen = _boxes(page)
        top, bottom = min(box["top"] for box in seen.values()), max(box["bottom"] for box in seen.values())
        assert bottom - top <= height, f"{frame}: map and clock need {bottom - top:.0f} px of {height}"
        assert seen["picture"]["bottom"] <= seen["place"]["bottom"] + 1, f"{frame}: the map spills"
        assert seen["place"]["bottom"] <= seen["clock"]["top"] + 1, f"{frame}: the map covers the clock"
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    visit.shot(f"flight-{width}")
    close(visit)


def test_on_a_phone_the_map_has_the_width_and_shares_the_screen(browser: Browser, url: str) -> None:
    """Fields, map and clock without scrolling; seen: a map of 260 px below the fields."""
    visit = opened(browser, url, 390, 844)
    page = visit.go("/dashboard?omega_t_deg_s=3&x_m=5&y_m=40")
    expect(page.locator("#play")).to_be_enabled()
    until(lambda: page.evaluate("document.getElementById('map').dataset.proved"), "the region")
    plot, line = page.locator("#map .nsewdrag").first.bounding_box(), page.locator("#play").bounding_box()
    title = page.locator("#map .gtitle").bounding_box()
    assert plot is not None
    assert line is not None
    assert title is not None
    assert plot["width"] > 0.8 * 390
    assert line["y"] + line["height"] <= 844
    assert title["y"] + title["height"] <= plot["y"], "a title of two lines stands above the picture"
    visit.shot("explore-390")
    close(visit)


def test_a_wide_picture_takes_the_width_of_the_first_screen(
    browser: Browser, url: str, database: Database
) -> None:
    """Seen: three maps side by side in a picture as wide as a finger."""
    jobs, inputs = JobRepository(database), process("coverage").example
    done = execute("coverage", inputs)
    job = jobs.submit("coverage", done.document["inputs"], timeout_s=60.0).id
    claim = jobs.claim("worker", 60.0)
    assert claim is not None
    jobs.succeed(claim, done.document, done.artifacts, {}, None)
    visit = opened(browser, url)
    page = visit.go(f"/dashboard/jobs/{job}")
    expect(page.locator(".first.panorama figure img")).to_be_visible()
    box = page.locator(".first figure img").bounding_box()
    assert box is not None
    assert box["width"] > 1000
    check_first_screen(page)
    close(visit)


def _boxes(page: Page) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = page.evaluate(
        """() => Object.fromEntries(Object.entries({ place: "#map", picture: "#map .main-svg", clock: "#flight-line" })
        .map(([name, selector]) => [name, document.querySelector(selector).getBoundingClientRect().toJSON()]))"""
    )
    return found


def test_a_key_is_shown_changed_and_forgotten(browser: Browser, tmp_path: Path) -> None:
    address = f"sqlite:///{tmp_path / 'keys.sqlite3'}"
    database = Database(address)
    database.migrate()
    keys = KeyRepository(database)
    reader = keys.create("reader", Role.READ, 1.0, LOCAL)[1]
    writer = keys.create("writer", Role.SUBMIT, 1.0, LOCAL)[1]
    with serving(address) as url:
        visit = opened(browser, url)
        visit.allowed.append("401")
        page = visit.go("/dashboard?omega_t_deg_s=3&x_m=5&y_m=40")
        expect(page.locator(".alone h2").first).to_have_text("This service needs a key")
        visit.shot("key")
        page.locator("#key").first.fill(reader)
        page.locator("text=Use this key").first.click()
        expect(page.locator("#who")).to_contain_text("reader · may read")
        with page.expect_download() as download:
            page.click("text=Download the proof")
        assert check(json.loads(Path(download.value.path()).read_text())).verdict == "GO"
        page.click("text=Change key")
        page.fill("#header-key", writer)
        page.click("#who >> text=Use this key")
        expect(page.locator("#who")).to_contain_text("writer · may submit")
        page.click("text=Forget key")
        expect(page.locator(".alone h2").first).to_have_text("This service needs a key")
        assert page.evaluate("sessionStorage.length") == 0
        close(visit)


def test_what_is_on_the_screen_as_a_command(browser: Browser, url: str) -> None:
    visit = opened(browser, url)
    page = visit.go("/dashboard?omega_t_deg_s=3&x_m=5&y_m=40&horizon_s=80")
    expect(page.locator("#verdict .word")).to_have_text("GO")
    page.click(".copies >> text=curl")
    said = page.locator(".copies pre").inner_text()
    sent = re.search(r"-d '(.*)'$", said)
    assert sent is not None
    answer = page.request.post(f"{url}/processes/go-no-go/execution", data=json.loads(sent[1]))
    assert answer.json()["verdict"] == ["GO"]
    assert json.loads(sent[1])["inputs"]["horizon_s"] == 80
    close(visit)
