"""Several starts at once, pinned beside each other; what the words mean, behind them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.conftest import Visit, visiting


@pytest.fixture
def visit(browser: Browser, url: str) -> Iterator[Visit]:
    with visiting(browser, url) as found:
        yield found


def test_pinned_starts_keep_their_question(visit: Visit) -> None:
    page = visit.go("/dashboard?omega_t_deg_s=3&x_m=5&y_m=40")
    expect(page.locator("#verdict .word")).to_have_text("GO")
    page.click("#pin")
    page.fill("#starts", "60 40\n2, 30")
    page.click("text=Check and pin them")
    rows = page.locator("#pinned tbody tr")
    expect(rows).to_have_count(3)
    assert page.locator("#pinned .word").all_inner_texts() == ["NO GO", "GO", "GO"]
    expect(page.locator("#map .legendtext", has_text="pinned starts")).to_have_count(1)
    said, elsewhere = page.locator("#pinned .note").first, page.locator("#pinned .elsewhere")
    expect(said).to_contain_text("All asked: tumble rate 3 deg/s · thrust acceleration 0.1 m/s² · stay 60 s")
    page.fill("#omega_t_deg_s", "5")
    expect(page.locator("#map .legendtext", has_text="pinned starts")).to_have_count(0)
    assert [one.is_visible() for one in elsewhere.all()] == [True] * 3, (
        "a GO of 3 deg/s beside a field that says 5 tells so"
    )
    page.fill("#omega_t_deg_s", "")
    assert [one.is_visible() for one in elsewhere.all()] == [True] * 3
    page.fill("#omega_t_deg_s", "3")
    assert [one.is_visible() for one in elsewhere.all()] == [False] * 3
    page.fill("#omega_t_deg_s", "5")
    assert page.locator("#pinned .word").all_inner_texts() == ["NO GO", "GO", "GO"], (
        "they answer their own question"
    )
    expect(page.locator("#pin")).to_be_enabled()
    page.click("#pin")
    expect(rows).to_have_count(4)
    expect(page.locator("#pinned th", has_text="Tumble rate [deg/s]")).to_be_visible()
    visit.shot("explore-pinned")
    rows.nth(2).get_by_text("Show").click()
    expect(page.locator("#omega_t_deg_s")).to_have_value("3")
    expect(page.locator("#y_m")).to_have_value("30")
    rows.nth(0).get_by_text("Unpin").click()
    expect(rows).to_have_count(3)
    page.fill("#starts", "1 2 3")
    page.click("text=Check and pin them")
    expect(page.locator("#several-state")).to_contain_text("Line 1: two numbers are required")


def test_a_word_is_explained_behind_it(visit: Visit) -> None:
    page = visit.go("/dashboard?omega_t_deg_s=3&x_m=5&y_m=40")
    expect(page.locator("#verdict .word")).to_have_text("GO")
    said = page.locator(".meaning:popover-open")
    page.get_by_role("button", name="What is Tumble rate?").focus()
    page.keyboard.press("Enter")
    expect(said).to_contain_text("How fast the target turns")
    page.keyboard.press("Escape")
    expect(said).to_have_count(0)
    page.get_by_role("button", name="What is GO?").click()
    expect(said.locator("dfn")).to_have_text("GO")
    assert page.get_by_label("Tumble rate", exact=True).first.input_value() == "3", (
        "the label is the field's still"
    )
