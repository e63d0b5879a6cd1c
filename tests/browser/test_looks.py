"""Colours and times as this browser shows them: chosen in the header, kept, and in the pictures too."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from tests.acceptance.running import serving
from tests.browser.conftest import Visit


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    address = f"sqlite:///{tmp_path_factory.mktemp('looks') / 'looks.sqlite3'}"
    database = Database(address)
    database.migrate()
    JobRepository(database).submit("benchmark", {}, timeout_s=60.0)
    with serving(address) as found:
        yield found


def ground(page: Page) -> str:
    found: str = page.evaluate("getComputedStyle(document.body).backgroundColor")
    return found


def test_colours_are_chosen_and_kept(browser: Browser, url: str) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 900}, color_scheme="light")
    visit = Visit(context, url)
    page = visit.go("/dashboard?omega_t_deg_s=3&x_m=5&y_m=40")
    expect(page.locator("#play")).to_be_enabled()
    light = ground(page)
    page.get_by_label("Colours").select_option("dark")
    assert ground(page) != light
    expect(page.locator("#map .bg").first).to_have_css("fill", "rgb(24, 32, 42)")
    inks = page.locator("#map .scatterlayer .js-line").evaluate_all(
        "all => all.map((one) => one.style.stroke)"
    )
    assert "rgb(23, 32, 43)" not in inks, "nothing is drawn dark on dark"
    dark = ground(page)
    page.goto(f"{url}/docs")
    assert ground(page) == dark, "on every page"
    page.get_by_label("Colours").select_option("system")
    assert ground(page) == light
    context.close()
    assert visit.faults() == []


def test_times_are_told_in_either_zone(browser: Browser, url: str) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 900}, timezone_id="Asia/Kolkata")
    visit = Visit(context, url)
    page = visit.go("/dashboard/jobs")
    moment = page.locator(".jobs time").first
    expect(moment).to_contain_text("UTC")
    page.get_by_label("Times").select_option("local")
    expect(moment).to_contain_text("+05:30")
    page.locator(".jobs .run > a").click()
    expect(page.locator("#course time").first).to_contain_text("+05:30")
    context.close()
    assert visit.faults() == []
