"""The address, the way back and what fills in forms: the verdict stays that of the inputs shown."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from safestart.runtime.access import LOCAL, Role
from safestart.store.access.keys import KeyRepository
from safestart.store.database import Database
from tests.acceptance.running import serving
from tests.browser.conftest import CHROMIUM, Visit, visiting
from tests.browser.explored import Truth, faults_in, seen
from tests.waiting import until

WORD = "#verdict .answer:not(.old) .word"
GO = "x_m=-60&y_m=80"
"""GO at 3 deg/s; at 4 deg/s NO GO."""


@pytest.fixture
def visit(browser: Browser, url: str) -> Iterator[Visit]:
    with visiting(browser, url) as found:
        yield found


def test_the_way_back_leads_to_the_question_of_its_address(visit: Visit) -> None:
    """Seen: after a link into the page and an edit, the way back changed the address alone."""
    page, truth = visit.go(f"/dashboard?{GO}"), Truth(visit.url)
    expect(page.locator(WORD)).to_have_text("GO")
    page.focus(".skip")
    page.keyboard.press("Enter")
    page.fill("#omega_t_deg_s", "4")
    expect(page.locator(WORD)).to_have_text("NO GO")
    page.go_back()
    assert seen(page)["fields"]["omega_t_deg_s"] == "3"
    expect(page.locator(WORD)).to_have_text("GO")
    assert faults_in(seen(page), truth) == []
    page.go_forward()
    expect(page.locator("#omega_t_deg_s")).to_have_value("4")
    expect(page.locator(WORD)).to_have_text("NO GO")
    assert faults_in(seen(page), truth) == []


@pytest.mark.parametrize(
    ("path", "there", "field", "other"),
    [
        ("/dashboard/approach?angle_deg=90", "#burns tbody tr", "#angle_deg", "40"),
        ("/dashboard/trade?stand_off_m=50", "#table tbody tr", "#stand_off_m", "30"),
        ("/dashboard/jobs?search=night", "#list .empty", "#search", "day"),
    ],
)
def test_so_it_does_on_other_pages(visit: Visit, path: str, there: str, field: str, other: str) -> None:
    page = visit.go(path)
    page.wait_for_selector(there)
    first = page.input_value(field)
    page.focus(".skip")
    page.keyboard.press("Enter")
    page.fill(field, other)
    expect(page).to_have_url(re.compile(f"={other}"))
    page.go_back()
    expect(page.locator(field)).to_have_value(first)
    page.wait_for_selector(there)


def test_an_address_after_many_quick_changes(browser: Browser, url: str) -> None:
    """A browser drops changes of the address that follow each other too fast, as a dragged slider makes them.

    Playwright's Chromium takes them all, unless it is told to behave as that of a user.
    """
    strict = browser.browser_type.launch(
        executable_path=CHROMIUM,
        args=["--no-sandbox"],
        ignore_default_args=["--disable-ipc-flooding-protection"],
    )
    page = strict.new_page()
    page.goto(f"{url}/dashboard?{GO}")
    expect(page.locator(WORD)).to_have_text("GO")
    page.evaluate(
        """() => {
          const field = document.getElementById("omega_t_deg_s");
          for (let k = 0; k <= 400; k++) {
            field.value = (k / 100).toFixed(2);
            field.dispatchEvent(new Event("input", { bubbles: true }));
          }
        }"""
    )
    until(lambda: "omega_t_deg_s=4.00" in page.evaluate("location.href"), "the last value")
    strict.close()


def test_a_change_without_a_key_is_a_change(visit: Visit) -> None:
    """What fills in forms may set a field and tell of a change alone."""
    page = visit.go(f"/dashboard?{GO}")
    expect(page.locator(WORD)).to_have_text("GO")
    page.locator("#omega_t_deg_s").evaluate(
        "(field) => { field.value = '4'; field.dispatchEvent(new Event('change', { bubbles: true })); }"
    )
    assert seen(page)["word"] is None
    expect(page.locator(WORD)).to_have_text("NO GO")


def test_a_number_that_cannot_be_read_is_not_its_default(visit: Visit) -> None:
    """Seen: "60e" in a field with a default of 60 s gave the answer for 60 s beside it."""
    visit.allowed.append("422")
    page = visit.go("/dashboard/submit?process=flight")
    expect(page.locator("#in-horizon_s")).to_be_attached()
    page.locator("details.rare").evaluate_all("(all) => all.forEach((one) => { one.open = true; })")
    page.locator("#in-horizon_s").press_sequentially("60e")
    page.click("text=Run now")
    expect(page.locator("#state .problem")).to_contain_text("horizon_s")
    expect(page.locator(".answered")).to_have_count(0)
    page.fill("#in-horizon_s", "40")
    page.click("text=Run now")
    expect(page.locator(".answered")).to_be_visible()


def test_a_command_leaves_with_its_inputs(visit: Visit) -> None:
    page = visit.go(f"/dashboard?{GO}")
    expect(page.locator(WORD)).to_have_text("GO")
    page.click(".copies >> text=curl")
    said = page.locator(".copies pre")
    expect(said).to_contain_text('"omega_t_deg_s":3')
    page.fill("#omega_t_deg_s", "4")
    expect(said).to_be_hidden()
    page.click(".copies >> text=curl")
    expect(said).to_contain_text('"omega_t_deg_s":4')


def test_the_way_back_shows_nothing_of_a_forgotten_key_and_a_form_that_can_be_sent(
    browser: Browser, tmp_path: Path
) -> None:
    """Pages are not kept by the browser: it would show them as they were left."""
    address = f"sqlite:///{tmp_path / 'keys.sqlite3'}"
    database = Database(address)
    database.migrate()
    key = KeyRepository(database).create("writer", Role.SUBMIT, 1.0, LOCAL)[1]
    with serving(address) as url:
        context = browser.new_context()
        visit = Visit(context, url)
        visit.allowed.append("401")
        page = visit.go("/dashboard/submit?process=benchmark")
        page.locator("#key").first.fill(key)
        page.locator("text=Use this key").first.click()
        page.click("#form button[type=submit]")
        page.wait_for_url(re.compile("/dashboard/jobs/[0-9a-f-]{36}"))
        expect(page.locator("h1 .status")).to_be_visible()
        page.go_back()
        expect(page.locator("#form button[type=submit]")).to_be_enabled()
        page.go_forward()
        expect(page.locator("h1 .status")).to_be_visible()
        page.goto(f"{url}/dashboard/jobs")
        page.click("text=Forget key")
        _asks_for_a_key(page)
        page.go_back()
        expect(page).to_have_url(re.compile("/dashboard/jobs/[0-9a-f-]{36}"))
        _asks_for_a_key(page)
        expect(page.locator("h1 .status")).to_have_count(0)
        context.close()
        assert visit.faults() == []


def _asks_for_a_key(page: Page) -> None:
    expect(page.locator(".alone h2").first).to_have_text("This service needs a key")
