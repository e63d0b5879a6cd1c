"""How long something takes is told before it is begun, and while it goes on."""

from __future__ import annotations

import re

from playwright.sync_api import Browser, expect

from safestart.processes.costs import region_s
from tests.browser.conftest import Visit


def test_an_estimate_stands_beside_the_button(browser: Browser, url: str) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    visit = Visit(context, url)
    page = visit.go("/dashboard/submit?process=safe-region")
    said = page.locator("#estimate")
    expect(said).to_contain_text("calculated from the inputs")
    before = said.inner_text()
    page.fill("#in-horizon_s", "600")
    expect(said).to_contain_text(f"about {region_s(600.0):.0f} s")
    assert said.inner_text() != before
    page = visit.go("/dashboard/submit?process=benchmark")
    expect(said).to_contain_text("not known")
    context.close()
    assert visit.faults() == []


def test_a_slow_region_tells_how_far_it_is(browser: Browser, url: str) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    visit = Visit(context, url)
    page = visit.go("/dashboard?omega_t_deg_s=3&horizon_s=280")
    expect(page.locator("#map-state .waiting")).to_have_text(
        re.compile(r"Proving the exact region: \d+ s of about \d+(\.\d)? s")
    )
    expect(page.locator("#map-state progress")).to_be_visible()
    page.fill("#horizon_s", "20")
    expect(page.locator("#map-state .waiting")).to_have_count(0)
    context.close()
    assert visit.faults() == []
